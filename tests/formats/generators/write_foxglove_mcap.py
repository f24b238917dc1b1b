# SPDX-License-Identifier: MIT
"""foxglove.PointCloud, encoded by hand, in MCAP files with and without chunks: write_foxglove_mcap.py FOLDER."""
import struct
import sys
import zlib

import lz4.frame
import numpy as np
import zstandard

from truth import Truth, packed, returns

MAGIC = b"\x89MCAP0\r\n"
STAMP_NS = 1_600_000_000_000_000_123
N = 70


def varint(value):
    out = b""
    while value > 127:
        out += bytes([value & 127 | 128])
        value >>= 7
    return out + bytes([value])


def part(number, content):
    return varint(number << 3 | 2) + varint(len(content)) + content


def doubles(*values):
    return b"".join(varint(i << 3 | 1) + struct.pack("<d", v) for i, v in enumerate(values, 1) if v)


def fixed32(number, value):
    return varint(number << 3 | 5) + struct.pack("<I", value) if value else b""


def number(field, value):
    return varint(field << 3) + varint(value)


def cloud(stamp, points, strengths, offsets_ns):
    """A stride with a gap; the pose turns by 90 degrees to the left and lifts by 2 m. UINT32 is 5, FLOAT32 7."""
    fields = [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 3), ("t", 16, 5)]
    data = packed([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("intensity", "<u2"), ("gap", "<u2"), ("t", "<u4")],
                  [*points.T, strengths, np.full(N, 777), offsets_ns])
    half = 0.5 ** 0.5
    pose = part(1, doubles(0, 0, 2)) + part(2, doubles(0, 0, half, half))
    out = part(1, number(1, stamp // 10**9) + number(2, stamp % 10**9)) + part(2, b"lidar") + part(3, pose)
    out += fixed32(4, 20)
    for name, offset, kind in fields:
        out += part(5, part(1, name.encode()) + fixed32(2, offset) + number(3, kind))
    return out + part(6, data)


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def record(opcode, content):
    return bytes([opcode]) + struct.pack("<Q", len(content)) + content


def schema():
    # A FileDescriptorSet with one empty message: enough of a schema for who knows the type by name.
    file = part(1, b"foxglove/PointCloud.proto") + part(2, b"foxglove") + part(4, part(1, b"PointCloud"))
    descriptors = part(1, file)
    return record(3, struct.pack("<H", 1) + text("foxglove.PointCloud") + text("protobuf") +
                  struct.pack("<I", len(descriptors)) + descriptors)


def channel():
    return record(4, struct.pack("<HH", 7, 1) + text("/cloud") + text("protobuf") + struct.pack("<I", 0))


def messages(truth, name):
    truth.log(name, "mcap")
    records = []
    for i in range(4):
        stamp = STAMP_NS + i * 100_000_000
        points = returns(N, i)
        offsets = np.arange(N) * 1_400_001
        content = struct.pack("<HIQQ", 7, i, stamp + 5000, stamp) + cloud(stamp, points, np.arange(N) + 500, offsets)
        records.append((stamp + 5000, record(5, content)))
        # x' = -y, y' = x, z' = z + 2
        moved = np.stack([-points[:, 1], points[:, 0], points[:, 2] + 2], 1)
        truth.scan(stamp, "start|unknown", "no|unknown", "recorded", moved, np.arange(N) + 500, offsets * 1e-9)
    return records


def chunk(group, compression, position):
    """A chunk, the index of its messages and the record that points to both."""
    head = schema() + channel()
    raw, entries = head, b""
    for time, data in group:
        entries += struct.pack("<QQ", time, len(raw))
        raw += data
    pack = {"": bytes, "lz4": lz4.frame.compress, "zstd": zstandard.ZstdCompressor().compress}[compression]
    small = pack(raw)
    start, end = group[0][0], group[-1][0]
    body = record(6, struct.pack("<QQQI", start, end, len(raw), zlib.crc32(raw)) + text(compression) +
                  struct.pack("<Q", len(small)) + small)
    index = record(7, struct.pack("<HI", 7, len(entries)) + entries)
    pointer = record(8, struct.pack("<QQQQ", start, end, position, len(body)) +
                     struct.pack("<IHQ", 10, 7, position + len(body)) + struct.pack("<Q", len(index)) +
                     text(compression) + struct.pack("<QQ", len(small), len(raw)))
    return body + index, pointer


def indexed(groups, compression):
    out = MAGIC + record(1, text("") + text("sheet"))
    pointers = b""
    for group in groups:
        bodies, pointer = chunk(group, compression, len(out))
        out += bodies
        pointers += pointer
    count = sum(len(group) for group in groups)
    times = [time for group in groups for time, _ in group]
    out += record(0x0F, struct.pack("<I", zlib.crc32(out)))
    statistics = record(0x0B, struct.pack("<QHIIIIQQ", count, 1, 1, 0, 0, len(groups), min(times), max(times)) +
                        struct.pack("<IHQ", 10, 7, count))
    summary = schema() + channel() + statistics + pointers
    foot = bytes([2]) + struct.pack("<QQQ", 20, len(out), 0)
    return out + summary + foot + struct.pack("<I", zlib.crc32(summary + foot)) + MAGIC


def plain(group):
    """As the fastest recorders write: no chunks and no summary."""
    out = MAGIC + record(1, text("") + text("sheet")) + schema() + channel()
    out += record(0x90, b"private") + b"".join(data for _, data in group)
    out += record(0x0F, struct.pack("<I", 0))
    return out + record(2, struct.pack("<QQI", 0, 0, 0)) + MAGIC


truth = Truth(sys.argv[1])
for compression in ("", "lz4", "zstd"):
    name = f"chunks_{compression or 'none'}.mcap"
    group = messages(truth, name)
    truth.bytes(name, indexed([group[:3], group[3:]], compression))
truth.bytes("plain.mcap", plain(messages(truth, "plain.mcap")))
