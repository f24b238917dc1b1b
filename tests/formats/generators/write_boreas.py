# SPDX-License-Identifier: MIT
"""Boreas and Boreas-RT: write_boreas.py FOLDER. VLS-128 and Aeva sweeps, poses of the LiDAR."""
import sys

import numpy as np

from truth import Truth, packed, returns

FIRST_US = 1_606_417_097_528_152
N = 60
k = np.arange(N)
HEADER = ("GPSTime,easting,northing,altitude,vel_east,vel_north,vel_up,roll,pitch,heading,"
          "angvel_z,angvel_y,angvel_x\n")


def lidar(truth):
    truth.log("boreas-2020-11-26-13-58", "boreas")
    for i in range(2):
        points = returns(N, i)
        seconds = np.float32(-0.05 + k * 0.1 / (N - 1))
        fields = [(name, "<f4") for name in ("x", "y", "z", "intensity", "laser", "time")]
        stamp_us = FIRST_US + i * 100_017
        truth.bytes(f"boreas-2020-11-26-13-58/lidar/{stamp_us}.bin",
                    packed(fields, [*points.T, k * 2, k % 128, seconds]))
        truth.scan(stamp_us * 1000, "middle", "no", "recorded", points, k * 2, seconds)


def aeva(truth):
    truth.log("boreas-rt/aeva", "boreas")
    names = ("x", "y", "z", "velocity", "intensity", "quality", "reflectivity", "time")
    fields = [(name, "<f4") for name in names] + [("flags", "<u8")]
    for i in range(2):
        points = returns(N, i + 5)
        seconds = np.float32(k * 0.0015)
        stamp_us = FIRST_US + i * 100_000
        truth.bytes(f"boreas-rt/aeva/{stamp_us}.bin",
                    packed(fields, [*points.T, k - 9.5, k * 3, k / 100, k + 0.5, seconds, k << 40]))
        truth.scan(stamp_us * 1000, "start", "no", "recorded", points, k * 3, seconds)


def poses(truth):
    for name in ("boreas-2020-11-26-13-58", "boreas-rt"):
        truth.text(f"{name}/calib/T_applanix_lidar.txt", "0 1 0 0\n-1 0 0 0\n0 0 1 0.13\n0 0 0 1\n")
    # Straight; heading of 90 degrees; roll and heading of 90 degrees.
    angles = ["0,0,0", "0,0,1.5707963267949", "1.5707963267949,0,1.5707963267949", "0,1.5707963267949,0"]
    rows = [f"{FIRST_US + i * 100_017},{10.5 + i},-20.25,3,1,2,0,{rpy},0.1,0.2,0.3\n"
            for i, rpy in enumerate(angles)]
    truth.text("boreas-2020-11-26-13-58/applanix/lidar_poses.csv", HEADER + "".join(rows))


truth = Truth(sys.argv[1])
lidar(truth)
aeva(truth)
poses(truth)
