# SPDX-License-Identifier: MIT
"""Reads PointCloud2 from an indexed MCAP file by the sheet, and every promise of the container with it.

read_mcap.py FILE FOLDER writes FOLDER/truth.txt as the generators do; anything wrong ends it with an error.
Messages are reached through the index only; checksums, counts and time ranges have to be right.
"""
import struct
import sys
import zlib

import lz4.frame
import numpy as np
import zstandard

from truth import Truth

MAGIC = b"\x89MCAP0\r\n"
UNPACK = {"": bytes, "lz4": lz4.frame.decompress,
          "zstd": lambda data: zstandard.ZstdDecompressor().decompress(data)}
TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}


class Reader:
    """Numbers and texts one after the other; CDR aligns, MCAP does not."""

    def __init__(self, data, aligned=False):
        self.data, self.at, self.aligned = data, 0, aligned

    def take(self, count):
        assert self.at + count <= len(self.data), "cut"
        self.at += count
        return self.data[self.at - count:self.at]

    def number(self, code):
        size = struct.calcsize("<" + code)
        if self.aligned:
            self.at += -self.at % size
        return struct.unpack("<" + code, self.take(size))[0]

    def text(self):
        value = self.take(self.number("I"))
        if self.aligned:
            assert value[-1:] == b"\0"
            value = value[:-1]
        return value.decode()

    def bytes(self):
        return self.take(self.number("I"))

    def left(self):
        return len(self.data) - self.at


def records(data):
    """(opcode, content, position) of records that fill `data` exactly."""
    reader = Reader(data)
    while reader.left():
        start = reader.at
        opcode = reader.number("B")
        yield opcode, reader.take(reader.number("Q")), start


def data_section(data):
    """Everything before the summary, which has to end with DataEnd and its checksum."""
    section = list(records(data[8:]))
    opcode, content, start = section[-1]
    assert section[0][0] == 1 and opcode == 0x0F
    crc = Reader(content).number("I")
    assert crc in (0, zlib.crc32(data[:8 + start])), "checksum of the data section"
    header = Reader(section[0][1])
    assert header.text() == "ros2", "profile"
    return section


def summary(data):
    foot = Reader(data[-28:-8])  # content of the footer, before it one byte and eight of length
    assert data[:8] == MAGIC and data[-8:] == MAGIC and data[-37] == 2
    start, offsets, crc = foot.number("Q"), foot.number("Q"), foot.number("I")
    assert start > 0 and crc in (0, zlib.crc32(data[start:-12])), "checksum of the summary"
    if offsets:
        for opcode, content, _ in records(data[offsets:-37]):
            group = Reader(content)
            kind, first, length = group.number("B"), group.number("Q"), group.number("Q")
            assert opcode == 0x0E and all(op == kind for op, _, _ in records(data[first:first + length]))
    return start, [(op, Reader(content)) for op, content, _ in records(data[start:offsets or -37])]


def chunk_of(data, entry):
    """The records of a chunk and the times and offsets of its messages, which its index says."""
    start, end, position, length = (entry.number("Q") for _ in range(4))
    places = Reader(entry.bytes())
    assert entry.number("Q") >= 0 and entry.text() in UNPACK
    opcode, content, _ = next(records(data[position:position + length]))
    assert opcode == 6 and length == 9 + len(content)
    chunk = Reader(content)
    assert (chunk.number("Q"), chunk.number("Q")) == (start, end)
    size, crc = chunk.number("Q"), chunk.number("I")
    raw = UNPACK[chunk.text()](chunk.take(chunk.number("Q")))
    assert len(raw) == size and crc in (0, zlib.crc32(raw)), "checksum of a chunk"
    index = []
    while places.left():
        channel, place = places.number("H"), places.number("Q")
        length = struct.unpack("<Q", data[place + 1:place + 9])[0]
        found = Reader(data[place + 9:place + 9 + length])
        assert data[place] == 7 and found.number("H") == channel
        rows = Reader(found.bytes())
        while rows.left():
            index.append((rows.number("Q"), rows.number("Q")))
    assert min(index)[0] == start and max(index)[0] == end
    return raw, index


def cloud(truth, data):
    kind = data[:2]
    assert kind == b"\0\1", "little-endian CDR"
    cdr = Reader(data[4:], aligned=True)
    stamp = cdr.number("i") * 10**9 + cdr.number("I")
    assert cdr.text() == "lidar"
    height, width = cdr.number("I"), cdr.number("I")
    names, kinds, offsets = [], [], []
    for _ in range(cdr.number("I")):
        names.append(cdr.text())
        offsets.append(cdr.number("I"))
        kinds.append("<" + TYPES[cdr.number("B")])
        assert cdr.number("I") == 1
    assert cdr.number("B") == 0
    step, row_step = cdr.number("I"), cdr.number("I")
    content = cdr.bytes()
    cdr.number("B")
    assert cdr.left() < 4 and row_step == width * step and len(content) == height * row_step
    table = np.frombuffer(content, np.dtype({"names": names, "formats": kinds, "offsets": offsets,
                                             "itemsize": step}))
    points = np.stack([table["x"], table["y"], table["z"]], 1)
    truth.scan(stamp, "-", "-", "-", points, table["intensity"] if "intensity" in names else None,
               table["time"] if "time" in names else None)


def main():
    data = open(sys.argv[1], "rb").read()
    truth = Truth(sys.argv[2])
    truth.log(sys.argv[1], "mcap")
    start, groups = summary(data)
    data_section(data[:start])
    schemas = {r.number("H"): (r.text(), r.text()) for op, r in groups if op == 3}
    channels = {r.number("H"): (r.number("H"), r.text(), r.text()) for op, r in groups if op == 4}
    count = [r.number("Q") for op, r in groups if op == 0x0B][0]
    times = []
    for raw, index in (chunk_of(data, r) for op, r in groups if op == 8):
        for time, offset in index:
            assert raw[offset] == 5
            message = Reader(raw[offset + 9:offset + 9 + struct.unpack("<Q", raw[offset + 1:offset + 9])[0]])
            schema, topic, encoding = channels[message.number("H")]
            assert schemas[schema] == ("sensor_msgs/msg/PointCloud2", "ros2msg")
            assert (topic, encoding) == ("/points", "cdr")
            message.number("I")
            assert message.number("Q") == time
            message.number("Q")
            times.append(time)
            cloud(truth, message.take(message.left()))
    assert len(times) == count and times == sorted(times)


main()
