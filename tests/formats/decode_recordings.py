# SPDX-License-Identifier: MIT
"""Every return of a recording, decoded by the published layouts alone.

decode_recordings.py velodyne|ouster|cloud RECORDING OUT

OUT: a 64-bit integer, the time in ns that times count from; then for each return six 64-bit
floats: number of its sweep, x, y, z [m], intensity, time [s].
RECORDING: a pcap with whole frames of one Velodyne (velodyne), a ROS 1 bag of Ouster's packets in
the profile RNG15_RFL8_NIR8 (ouster), or one of PointCloud2 in which every point has an absolute
time (cloud).
"""
import bz2
import json
import struct
import sys

import numpy as np


def bag_messages(content):
    """(topic, time of recording [ns], message) of a ROS 1 bag that was closed."""

    def records(data):
        at = 0
        while at < len(data):
            size, = struct.unpack_from("<I", data, at)
            fields, field = {}, at + 4
            while field < at + 4 + size:
                length, = struct.unpack_from("<I", data, field)
                name, _, value = data[field + 4:field + 4 + length].partition(b"=")
                fields[name.decode()] = value
                field += 4 + length
            at += 4 + size
            size, = struct.unpack_from("<I", data, at)
            yield fields, data[at + 4:at + 4 + size]
            at += 4 + size

    topics = {}
    for fields, data in records(content[13:]):
        if fields["op"] != b"\x05":
            continue
        kind = fields["compression"]
        if kind == b"lz4":
            import lz4.frame
            data = lz4.frame.decompress(data)
        elif kind == b"bz2":
            data = bz2.decompress(data)
        for inner, message in records(data):
            number = inner["conn"]
            if inner["op"] == b"\x07":
                topics[number] = inner["topic"].decode()
            elif inner["op"] == b"\x02":
                seconds, ns = struct.unpack("<II", inner["time"])
                yield topics[number], seconds * 10**9 + ns, message


def cloud(content):
    rows, base = [], None
    clouds = (m for topic, _, m in bag_messages(content) if topic == "/lidar/points")
    for number, message in enumerate(clouds):
        _, seconds, ns, length = struct.unpack_from("<IIII", message)
        at = 16 + length
        height, width, field_count = struct.unpack_from("<III", message, at)
        at += 12
        fields = {}
        for _ in range(field_count):
            length, = struct.unpack_from("<I", message, at)
            offset, kind = struct.unpack_from("<IB", message, at + 4 + length)
            fields[message[at + 4:at + 4 + length].decode()] = (offset, {4: "<u2", 7: "<f4", 8: "<f8"}[kind])
            at += 4 + length + 9
        step, = struct.unpack_from("<I", message, at + 1)
        data = message[at + 13:at + 13 + height * width * step]
        names = list(fields)
        kind = np.dtype({"names": names, "offsets": [fields[n][0] for n in names],
                         "formats": [fields[n][1] for n in names], "itemsize": step})
        points = np.frombuffer(data, kind)
        base = base or seconds * 10**9 + ns
        time = (points["timestamp"] - base // 10**9) - base % 10**9 * 1e-9
        rows.append(np.column_stack([np.full(len(points), number), points["x"], points["y"], points["z"],
                                     points["intensity"], time]))
    return base, np.concatenate(rows)


def ouster(content):
    """Packets of one frame, on a clock that counts from when the sensor was switched on."""
    packets, about, base = [], None, None
    for topic, time, message in bag_messages(content):
        size, = struct.unpack_from("<I", message)
        if topic.endswith("/metadata"):
            about = json.loads(message[4:4 + size])
        if topic.endswith("/lidar_packets"):
            base = base or time
            packets.append(message[4:4 + size])
    beams, optics = about["lidar_data_format"]["pixels_per_column"], about["beam_intrinsics"]
    width = about["lidar_data_format"]["columns_per_frame"]
    altitude = np.radians(optics["beam_altitude_angles"])
    aside = -np.radians(optics["beam_azimuth_angles"])
    n = optics["beam_to_lidar_transform"][3]
    mount = np.array(about["lidar_intrinsics"]["lidar_to_sensor_transform"]).reshape(4, 4)
    columns, first = {}, None
    for packet in packets:
        for i in range(16):
            column = packet[32 + i * (12 + 4 * beams):][:12 + 4 * beams]
            time, place, status = struct.unpack_from("<QHH", column)
            if status & 1:
                columns[place] = (time, np.frombuffer(column, "<u4", beams, 12))
                first = min(time, first or time)
    rows = []
    for place in sorted(columns):
        time, words = columns[place]
        there = (words & 0x7FFF) > 0
        r = 8.0 * (words & 0x7FFF) - n
        encoder = 2 * np.pi * (1 - place / width)
        x = r * np.cos(encoder + aside) * np.cos(altitude) + n * np.cos(encoder)
        y = r * np.sin(encoder + aside) * np.cos(altitude) + n * np.sin(encoder)
        z = r * np.sin(altitude)
        points = np.column_stack([x, y, z]) @ mount[:3, :3].T + mount[:3, 3]
        rows.append(np.column_stack([np.zeros(beams), points * 1e-3, words >> 16 & 255,
                                     np.full(beams, (time - first) * 1e-9)])[there])
    return base, np.concatenate(rows)


VLP_16 = [-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15]
HDL_32E = [round(value, 2) for k in range(16) for value in (-92 / 3 + 4 * k / 3, -28 / 3 + 4 * k / 3)]


def velodyne_packets(content):
    """(time [us], payload) of frames that hold whole datagrams of 1206 bytes."""
    at = 24
    while at < len(content):
        seconds, us, captured = struct.unpack_from("<III", content, at)
        if captured == 42 + 1206:
            yield seconds * 10**6 + us, content[at + 58:at + 16 + captured]
        at += 16 + captured


def velodyne(content):
    rows, base, turned, before = [], None, 0.0, None
    hour = 3600 * 10**6
    j = np.arange(32)
    for host, packet in velodyne_packets(content):
        past, = struct.unpack_from("<I", packet, 1200)
        start = host // hour * hour + past
        start += hour if start < host - hour // 2 else -hour if start > host + hour // 2 else 0
        base = base or start
        small = packet[1205] == 0x22
        block_us = 110.592 if small else 46.08
        shot_us = 55.296 * (j // 16) + 2.304 * (j % 16) if small else 1.152 * j
        elevation = np.radians(VLP_16 + VLP_16 if small else HDL_32E)
        azimuths = [struct.unpack_from("<H", packet, 100 * b + 2)[0] * 0.01 for b in range(12)]
        rate = (azimuths[11] - azimuths[0]) % 360 / (11 * block_us)
        for b, azimuth in enumerate(azimuths):
            turned += (azimuth - (azimuth if before is None else before)) % 360
            before = azimuth
            raw = np.frombuffer(packet, np.uint8, 96, 100 * b + 4).reshape(32, 3)
            d = 0.002 * (raw[:, 0] + 256.0 * raw[:, 1])
            a = np.radians(azimuth + rate * shot_us)
            time = (start - base + b * block_us + shot_us) * 1e-6
            rows.append(np.column_stack([np.full(32, np.floor((turned + 0.005) / 360)),
                                         d * np.cos(elevation) * np.cos(a), -d * np.cos(elevation) * np.sin(a),
                                         d * np.sin(elevation), raw[:, 2], time])[d > 0])
    return base * 1000, np.concatenate(rows)


def main():
    kind, recording, out = sys.argv[1:4]
    with open(recording, "rb") as file:
        base, rows = {"velodyne": velodyne, "ouster": ouster, "cloud": cloud}[kind](file.read())
    with open(out, "wb") as file:
        file.write(struct.pack("<q", base) + np.ascontiguousarray(rows, "<f8").tobytes())


main()
