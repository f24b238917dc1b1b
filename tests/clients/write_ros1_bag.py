# SPDX-License-Identifier: MIT
"""A folder of binary PCD scans as a ROS 1 bag, written by ROS's own library.

write_ros1_bag.py LOG_FOLDER OUT.bag none|bz2|lz4 [chunk bytes]

Stamps come from times.txt, else from the names; beside the clouds there are other topics.
"""
import pathlib
import sys

import genpy
import rosbag
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, NavSatFix, PointCloud2, PointField

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from pcd_log import read_pcd, stamped_scans


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
    log, out, compression = sys.argv[1:4]
    threshold = int(sys.argv[4]) if len(sys.argv) > 4 else 768 * 1024
    with rosbag.Bag(out, "w", compression=compression, chunk_threshold=threshold) as bag:
        for path, ns in stamped_scans(log):
            stamp = genpy.Time(ns // 10**9, ns % 10**9)
            bag.write("/imu", Imu(), stamp)
            bag.write("/points", cloud(path, stamp), stamp)
            bag.write("/fix", NavSatFix(), stamp)
            bag.write("/odometry", Odometry(), stamp)


main()
