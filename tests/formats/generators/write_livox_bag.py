# SPDX-License-Identifier: MIT
"""Livox CustomMsg of both drivers in ROS 1 bags, by ROS's own library: write_livox_bag.py FOLDER."""
import sys

import genpy
import genpy.dynamic
import numpy as np
import rosbag

from truth import Truth, returns

STAMP_NS = 1_600_000_000_250_000_000
N = 80
SEPARATOR = "=" * 80 + "\n"


def definition(package):
    return ("Header header\nuint64 timebase\nuint32 point_num\nuint8 lidar_id\nuint8[3] rsvd\n"
            "CustomPoint[] points\n" + SEPARATOR +
            "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n" + SEPARATOR +
            f"MSG: {package}/CustomPoint\nuint32 offset_time\nfloat32 x\nfloat32 y\nfloat32 z\n"
            "uint8 reflectivity\nuint8 tag\nuint8 line\n")


def message(types, package, stamp, points, reflectivity, offsets):
    custom = types[f"{package}/CustomMsg"]()
    custom.header.stamp = genpy.Time(stamp // 10**9, stamp % 10**9)
    custom.header.frame_id = "livox_frame"
    custom.timebase = stamp
    custom.point_num = len(points)
    custom.rsvd = [0, 0, 0]
    for point, strength, offset in zip(points, reflectivity, offsets):
        p = types[f"{package}/CustomPoint"]()
        p.offset_time, p.reflectivity, p.tag, p.line = int(offset), int(strength), 0x10, 3
        p.x, p.y, p.z = map(float, point)
        custom.points.append(p)
    return custom


def main():
    truth = Truth(sys.argv[1])
    for package in ("livox_ros_driver", "livox_ros_driver2"):
        types = genpy.dynamic.generate_dynamic(f"{package}/CustomMsg", definition(package))
        truth.log(f"{package}.bag", "rosbag")
        with rosbag.Bag(str(truth.folder / f"{package}.bag"), "w") as bag:
            for i in range(3):
                stamp = STAMP_NS + i * 100_000_000
                points = returns(N, i)
                points[5] = points[40] = 0  # no return
                offsets = np.arange(N) * 1_250_007
                seen = np.any(points != 0, 1)
                bag.write("/livox/lidar", message(types, package, stamp, points, np.arange(N), offsets),
                          genpy.Time(stamp // 10**9, stamp % 10**9 + 1000))
                truth.scan(stamp, "start|unknown", "no|unknown", "recorded", points[seen], np.arange(N)[seen],
                           offsets[seen] * 1e-9, zero=2)


main()
