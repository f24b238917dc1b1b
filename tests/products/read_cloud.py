# SPDX-License-Identifier: MIT
"""Prints a PCD, PLY or LAS file as text: the names of its columns, then a line a point.

Written from the specifications alone. Everything a reader might trip over is an error here.
LAS: `read_cloud.py FILE header` prints the header instead, a name and its values a line.
"""
import struct
import sys

import numpy as np


def unpack_lzf(data, size):
    out = bytearray()
    i = 0
    while i < len(data):
        control = data[i]
        i += 1
        if control < 32:
            out += data[i:i + control + 1]
            i += control + 1
            continue
        length = control >> 5
        if length == 7:
            length += data[i]
            i += 1
        back = ((control & 31) << 8 | data[i]) + 1
        i += 1
        assert back <= len(out), 'points before the beginning'
        for _ in range(length + 2):
            out.append(out[-back])
    assert i == len(data) and len(out) == size, 'sizes do not agree'
    return bytes(out)


def read_pcd(data):
    fields, encoding, begin = {}, None, 0
    while encoding is None:
        end = data.index(b'\n', begin)
        words = data[begin:end].decode('ascii').split()
        begin = end + 1
        if words[0].startswith('#'):
            continue
        fields[words[0]] = words[1:]
        if words[0] == 'DATA':
            encoding = words[1]
    order = ['VERSION', 'FIELDS', 'SIZE', 'TYPE', 'COUNT', 'WIDTH', 'HEIGHT', 'VIEWPOINT', 'POINTS', 'DATA']
    assert list(fields) == order, fields
    assert set(fields['COUNT']) == {'1'} and fields['HEIGHT'] == ['1']
    assert fields['VIEWPOINT'] == '0 0 0 1 0 0 0'.split()
    points = int(fields['POINTS'][0])
    assert fields['WIDTH'] == fields['POINTS']
    kinds = {('F', '4'): '<f4', ('F', '8'): '<f8', ('U', '4'): '<u4'}
    types = [kinds[kind] for kind in zip(fields['TYPE'], fields['SIZE'])]
    types = ['<u4' if name == 'rgb' else kind for name, kind in zip(fields['FIELDS'], types)]
    payload = data[begin:]
    if encoding == 'binary':
        record = np.dtype(list(zip(fields['FIELDS'], types)))
        assert len(payload) == points * record.itemsize, 'length of the payload'
        records = np.frombuffer(payload, record)
        columns = [records[name] for name in fields['FIELDS']]
    else:
        packed, raw = struct.unpack_from('<II', payload)
        assert len(payload) == 8 + packed, 'length of the payload'
        plain = unpack_lzf(payload[8:], raw)
        columns, begin = [], 0
        for kind in types:
            columns.append(np.frombuffer(plain, kind, points, begin))
            begin += points * np.dtype(kind).itemsize
        assert begin == raw
    return fields['FIELDS'], columns


def read_ply(data):
    lines, begin = [], 0
    while not lines or lines[-1] != 'end_header':
        end = data.index(b'\n', begin)
        lines.append(data[begin:end].decode('ascii'))
        begin = end + 1
    assert lines[:2] == ['ply', 'format binary_little_endian 1.0']
    words = [line.split() for line in lines if not line.startswith('comment')][2:-1]
    assert words[0][:2] == ['element', 'vertex'] and all(w[0] == 'property' for w in words[1:])
    kinds = {'float': '<f4', 'double': '<f8', 'uint': '<u4', 'uchar': 'u1'}
    record = np.dtype([(name, kinds[kind]) for _, kind, name in words[1:]])
    assert len(data) - begin == int(words[0][2]) * record.itemsize, 'length of the payload'
    records = np.frombuffer(data[begin:], record)
    return list(record.names), [records[name] for name in record.names]


def las_header(data):
    at = struct.unpack_from
    assert data[:4] == b'LASF' and data[24] == 1 and data[25] in (2, 4)
    h = {'version': [data[24], data[25]], 'encoding': at('<H', data, 6), 'size': at('<H', data, 94),
         'begin': at('<I', data, 96), 'records': at('<I', data, 100), 'format': [data[104]],
         'length': at('<H', data, 105), 'legacy': at('<I', data, 107), 'returns': at('<5I', data, 111),
         'scale': at('<3d', data, 131), 'offset': at('<3d', data, 155), 'bounds': at('<6d', data, 179)}
    assert h['size'][0] == {2: 227, 4: 375}[data[25]]
    if data[25] == 4:
        assert at('<QQI', data, 227) == (0, 0, 0)
        h['points'] = at('<Q', data, 247)
        h['wide_returns'] = at('<15Q', data, 255)
    else:
        h['points'] = h['legacy']
    return h


def las_extra_fields(data, h):
    fields, begin = [], h['size'][0]
    for _ in range(h['records'][0]):
        reserved, user, number, length = struct.unpack_from('<H16sHH', data, begin)
        assert reserved == 0 and user.rstrip(b'\0') == b'LASF_Spec' and number == 4
        for i in range(begin + 54, begin + 54 + length, 192):
            kind = {5: '<u4', 9: '<f4', 10: '<f8'}[data[i + 2]]
            assert data[i + 3] == 0, 'options without values'
            fields.append((data[i + 4:i + 36].rstrip(b'\0').decode('ascii'), kind))
        begin += 54 + length
    assert begin == h['begin'][0]
    return fields


def read_las(data):
    h = las_header(data)
    fields = [('x', '<i4'), ('y', '<i4'), ('z', '<i4'), ('intensity', '<u2'), ('flags', 'u1'),
              ('class', 'u1'), ('angle', 'i1'), ('user', 'u1'), ('source', '<u2')]
    if h['format'][0] & 1:
        fields += [('time', '<f8')]
    if h['format'][0] & 2:
        fields += [('red', '<u2'), ('green', '<u2'), ('blue', '<u2')]
    fields += las_extra_fields(data, h)
    record = np.dtype(fields)
    assert record.itemsize == h['length'][0]
    payload = data[h['begin'][0]:]
    assert len(payload) == h['points'][0] * record.itemsize, 'length of the payload'
    records = np.frombuffer(payload, record)
    assert (records['flags'] == 9).all() and (records['class'] == 1).all()
    columns = []
    for name in record.names:
        column = records[name]
        if name in 'xyz':
            axis = 'xyz'.index(name)
            column = column * h['scale'][axis] + h['offset'][axis]
            if len(column):
                assert h['bounds'][2 * axis] == column.max() and h['bounds'][2 * axis + 1] == column.min()
        columns.append(column)
    return list(record.names), columns


def main():
    with open(sys.argv[1], 'rb') as file:
        data = file.read()
    if sys.argv[2:] == ['header']:
        for name, values in las_header(data).items():
            print(name, *values)
        return
    read = {'.pcd': read_pcd, '.ply': read_ply, '.las': read_las}[sys.argv[1][-4:].lower()]
    names, columns = read(data)
    print(*names)
    np.savetxt(sys.stdout, np.array([c.astype('f8') for c in columns]).T.reshape(-1, len(names)), fmt='%.17g')


main()
