# SPDX-License-Identifier: MIT
"""A folder of binary PCD scans as a ROS 1 bag, written by ROS's own library.

write_ros1_bag.py LOG_FOLDER OUT.bag none|bz2|lz4 [chunk bytes]

Stamps come from times.txt, else from the names; beside the clouds there are other topics.
"""
import decimal
import pathlib
import sys

import genpy
import rosbag
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, NavSatFix, PointCloud2, PointField


def read_pcd(path):
    """Bytes of the points, and how many bytes and fields each has."""
    content = path.read_bytes()
    end = content.index(b"DATA binary\n") + len(b"DATA binary\n")
    head = dict(line.split(" ", 1) for line in content[:end].decode().splitlines() if not line.startswith("#"))
    count = int(head["POINTS"])
    fields = head["FIELDS"].split()
    return content[end:end + count * 4 * len(fields)], count, fields


def stamps_of(folder, scans):
    times = folder / "times.txt"
    if times.exists():
        exact = [decimal.Decimal(line) for line in times.read_text().split()]
        return [int((t * 10**9).to_integral_value(decimal.ROUND_HALF_EVEN)) for t in exact]
    return [int(a) * 10**9 + int(b) for a, b in (p.stem.split("_") for p in scans)]


def cloud(path, stamp):
    data, count, fields = read_pcd(path)
    message = PointCloud2()
    message.header.stamp = stamp
    message.header.frame_id = "lidar"
    message.height, message.width = 1, count
    message.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(fields)]
    message.point_step = 4 * len(fields)
    message.row_step = message.point_step * count
    message.data = data
    message.is_dense = False
    return message


def main():
    log, out, compression = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    folder = log / "scans" if (log / "scans").is_dir() else log
    scans = sorted(folder.glob("*.pcd"), key=lambda p: tuple(int(s) for s in p.stem.split("_")))
    stamps = stamps_of(log, scans)
    threshold = int(sys.argv[4]) if len(sys.argv) > 4 else 768 * 1024
    with rosbag.Bag(out, "w", compression=compression, chunk_threshold=threshold) as bag:
        for path, ns in zip(scans, stamps):
            stamp = genpy.Time(ns // 10**9, ns % 10**9)
            bag.write("/imu", Imu(), stamp)
            bag.write("/points", cloud(path, stamp), stamp)
            bag.write("/fix", NavSatFix(), stamp)
            bag.write("/odometry", Odometry(), stamp)


main()
