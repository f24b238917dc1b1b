# SPDX-License-Identifier: MIT
"""KITTI odometry and raw: write_kitti.py FOLDER. Two scans each; ground truth of a car going 5 m ahead."""
import sys

import numpy as np

from truth import Truth, packed, returns

FIELDS = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("reflectance", "<f4")]


def raised(points):
    """The same ranges and azimuths, 0.205 degrees higher: what the HDL-64E of KITTI needs."""
    p = points.astype(float)
    distance = np.linalg.norm(p, axis=1)
    azimuth = np.arctan2(p[:, 1], p[:, 0])
    elevation = np.arcsin(p[:, 2] / distance) + np.radians(0.205)
    return np.stack([distance * np.cos(elevation) * np.cos(azimuth),
                     distance * np.cos(elevation) * np.sin(azimuth), distance * np.sin(elevation)], 1)


def odometry(truth):
    truth.log("sequences/00", "kitti")
    for i in range(2):
        points = returns(60, i)
        points[0] = (10, 0, 0)
        reflectance = np.arange(60) / 64
        truth.bytes(f"sequences/00/velodyne/{i:06}.bin", packed(FIELDS, [*points.T, reflectance]))
        truth.scan((0, 103_622_400)[i], "middle|unknown", "yes", "none", raised(points), reflectance)
    truth.text("sequences/00/times.txt", "0.000000e+00\n1.036224e-01\n")
    # x of the LiDAR is z of the camera, y is -x, z is -y; it sits 0.3 m behind and 0.1 m above it.
    projection = "P%d: 700 0 600 0 0 700 180 0 0 0 1 0\n"
    truth.text("sequences/00/calib.txt", "calib_time: 09-Jan-2012 13:57:47\n" +
               "".join(projection % i for i in range(4)) + "Tr: 0 -1 0 0 0 0 -1 -0.1 1 0 0 -0.3\n")
    # Second pose: 5 m ahead, then turned to the left by 90 degrees (about -y of the camera).
    truth.text("poses/00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 -1 0 0 1 0 0 1 0 0 5\n")


def raw(truth):
    drive = "2011_09_26/2011_09_26_drive_0001_sync"
    truth.log(drive, "kitti-raw")
    seconds = {0: 1.25, 2: 1.45}  # the scan between them is missing, and its lines are empty
    lines = {"timestamps": [], "timestamps_start": [], "timestamps_end": []}
    for i in range(3):
        for (name, rows), shift in zip(lines.items(), (0, -0.05, 0.05)):
            rows.append(f"2011-09-26 13:02:{seconds[i] + shift + 25:.9f}" if i in seconds else "")
        if i not in seconds:
            continue
        points = returns(60, i)
        points[:3] = [(1, 0, 0), (0, 1, 0), (0, -1, 0)]
        reflectance = np.arange(60) / 64
        truth.bytes(f"{drive}/velodyne_points/data/{i:010}.bin", packed(FIELDS, [*points.T, reflectance]))
        part = 0.5 * (1 - np.arctan2(points[:, 1], points[:, 0]) / np.pi)
        # 26 September 2011, 13:02:25 is 1317042145 s after 1970, if the clock is UTC.
        stamp = 1_317_042_145_000_000_000 + round(seconds[i] * 1e9)
        truth.scan(stamp, "middle|unknown", "no", "derived", points, reflectance, -0.05 + 0.1 * part)
    for name, rows in lines.items():
        truth.text(f"{drive}/velodyne_points/{name}.txt", "\n".join(rows) + "\n")


truth = Truth(sys.argv[1])
odometry(truth)
raw(truth)
