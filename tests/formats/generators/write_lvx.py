# SPDX-License-Identifier: MIT
"""Livox LVX 1.0 and 1.1: write_lvx.py FOLDER. Every type of data the reader knows, one file each."""
import struct
import sys

import numpy as np

from truth import Truth, packed

MM = [("x", "<i4"), ("y", "<i4"), ("z", "<i4"), ("reflectivity", "u1")]
FRAME_MS = 50
START_NS = 1_600_000_000_000_000_000


def returns_of_packet(count, packet):
    """Millimetres, whole numbers; ahead of the sensor, as Livox sees."""
    k = np.arange(count)
    points = np.stack([5000 + k * 13 + packet, -2500 + k * 29, 800 - k * 17], 1)
    return points, k % 200


def cartesian(packet, count, per_shot, tagged):
    """`count` shots of `per_shot` returns each."""
    points, strengths = returns_of_packet(count * per_shot, packet)
    fields = MM + ([("tag", "u1")] if tagged else [])
    columns = [*points.T, strengths] + ([np.zeros(len(points))] if tagged else [])
    return packed(fields, columns), points / 1000, strengths


def spherical(packet, count):
    """Depth in mm, then zenith and azimuth in hundredths of a degree."""
    k = np.arange(count)
    depth, zenith, azimuth = 9000 + k * 21 + packet, 8500 + k * 7, (36000 - 700 + k * 13) % 36000
    theta, phi = np.radians(zenith / 100), np.radians(azimuth / 100)
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], 1)
    data = packed([("depth", "<u4"), ("zenith", "<u2"), ("azimuth", "<u2"), ("reflectivity", "u1")],
                  [depth, zenith, azimuth, k % 200])
    return data, points * depth[:, None] / 1000, k % 200


TYPES = {0: lambda p: cartesian(p, 100, 1, False), 1: lambda p: spherical(p, 100),
         2: lambda p: cartesian(p, 96, 1, True), 4: lambda p: cartesian(p, 48, 2, True),
         7: lambda p: cartesian(p, 30, 3, True)}


def packet_bytes(data_type, stamp_ns, data):
    # device, version, port, lidar, reserved, error, type of stamp (1: PTP, ns), type of data, stamp
    return struct.pack("<BBBBBIBBQ", 0, 5, 0, 1, 0, 0, 1, data_type, stamp_ns) + data


def lvx(frames, minor):
    """The file around frames of packets. Each frame says where it and the next begin."""
    head = b"livox_tech".ljust(16, b"\0") + bytes([1, minor, 0, 0]) + struct.pack("<I", 0xAC0EA767)
    device = b"1PQDH5B00100041".ljust(16, b"\0") + b"\0" * 16 + bytes([0, 1])
    if minor == 1:
        head += struct.pack("<IB", FRAME_MS, 1) + device + b"\0" + b"\0" * 24
    else:
        head += struct.pack("<B", 1) + device + b"\0" * 24
    for index, packets in enumerate(frames):
        body = b"".join(packets)
        size = 24 + (8 if minor == 0 else 0) + len(body)
        head += struct.pack("<QQQ", len(head), len(head) + size, index)
        head += struct.pack("<Q", len(packets)) if minor == 0 else b""
        head += body
    return head


def write(truth, name, data_type, minor):
    frames, points, strengths, times = [], [], [], []
    for frame in range(4):
        packets = []
        for p in range(3):
            since_start = frame * FRAME_MS * 1_000_000 + p * 10_000_000
            data, seen, strength = TYPES[data_type](3 * frame + p)
            packets.append(packet_bytes(data_type, START_NS + since_start, data))
            if p == 1:  # the inertial unit's are in between
                packets.append(packet_bytes(6, START_NS + since_start + 5, struct.pack("<6f", *range(6))))
            points.append(seen)
            strengths.append(strength)
            times.append(np.full(len(seen), since_start * 1e-9))
        frames.append(packets)
    truth.bytes(name, lvx(frames, minor))
    truth.log(name, "lvx")
    truth.stream(START_NS, "unknown|start|end", "no", "recorded", np.concatenate(points),
                 np.concatenate(strengths), np.concatenate(times))


def write_unread(truth, name, data_type, size):
    """Types whose layout the sheet does not tell: to be refused, not guessed."""
    truth.bytes(name, lvx([[packet_bytes(data_type, START_NS, b"\1" * size)]], 1))
    truth.log(name, "lvx")
    truth.refused()


truth = Truth(sys.argv[1])
for data_type in TYPES:
    write(truth, f"type{data_type}.lvx", data_type, 1)
write(truth, "version0.lvx", 0, 0)
write_unread(truth, "type3.lvx", 3, 96 * 10)
write_unread(truth, "type5.lvx", 5, 48 * 16)
