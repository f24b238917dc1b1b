# SPDX-License-Identifier: MIT
"""Apollo SouthBay and Newer College 2020, whose scans are PCD: write_pcd_sets.py FOLDER."""
import sys

import numpy as np

from pcd import pcd
from truth import Truth, returns

NAMES = ["x", "y", "z", "intensity"]


def apollo(truth):
    drive = "apollo/TestData/ColumbiaPark/2018-10-11"
    truth.log(drive, "apollo")
    poses = []
    for scan in range(1, 13):  # 1, 10, 11, 12, 2 is how names would sort
        points = returns(40, scan)
        columns = np.column_stack([points, np.arange(40) + scan]).astype(np.float32)
        columns[7, :3] = np.nan
        encoding = "ascii" if scan == 3 else "binary"
        truth.bytes(f"{drive}/pcds/{scan}.pcd", pcd(NAMES, ["<f4"] * 4, columns.T, encoding))
        kept = np.delete(columns, 7, 0)
        stamp = 1_539_300_000_000_000_000 + scan * 100_000_000
        truth.scan(stamp, "unknown|start|middle|end", "unknown", "none", kept[:, :3], kept[:, 3], non_finite=1)
        poses.append(f"{scan} {stamp // 10**9}.{stamp % 10**9:09} {588000 + scan}.5 4140000.25 -3.5 0 0 0.6 0.8")
    truth.text(f"{drive}/poses/gt_poses.txt", "\n".join(poses) + "\n")


def newer_college_scan(truth, name, stamp, seen, records=65536):
    points = returns(len(seen), len(seen))
    table = np.zeros((records, 4), np.float32)
    table[seen, :3] = points
    table[seen, 3] = np.arange(len(seen)) * 4
    truth.bytes(f"short/raw_format/ouster_scan/{name}.pcd", pcd(NAMES, ["<f4"] * 4, table.T))
    whole = records == 65536
    times = (np.array(seen) // 64) / 1024 * 0.1 if whole else None
    truth.scan(stamp, "unknown|start", "no|unknown", "derived" if whole else "none", points,
               np.arange(len(seen)) * 4, times, zero=records - len(seen))


def newer_college(truth):
    truth.log("short", "newer-college")
    # As text, the first name sorts after the second.
    newer_college_scan(truth, "cloud_1583836591_5", 1_583_836_591_000_000_005, [0, 63, 64, 130, 65535])
    newer_college_scan(truth, "cloud_1583836591_182590976", 1_583_836_591_182_590_976,
                       list(range(7, 65536, 997)))
    newer_college_scan(truth, "cloud_1583836592_1", 1_583_836_592_000_000_001, [3, 500, 999], 1000)
    row = "1583836591,%s,1,2,3,0,0,0,1\n"
    # A row twice, as in dynamic_spinning; then the camera turns to the left by 90 degrees.
    truth.text("short/ground_truth/registered_poses.csv", "#sec,nsec,x,y,z,qx,qy,qz,qw\n" + row % "5" +
               row % "5" + "1583836591,182590976,4,2,3,0,0,0.70710678118,0.70710678118\n")


truth = Truth(sys.argv[1])
apollo(truth)
newer_college(truth)
