# SPDX-License-Identifier: MIT
"""HeLiPR: write_helipr.py FOLDER. One sequence with the four LiDARs; the Aeva changes its record on the way."""
import sys

import numpy as np

from truth import Truth, packed, returns

XYZ = [("x", "<f4"), ("y", "<f4"), ("z", "<f4")]
LAST_SHORT_AEVA = 1_691_936_557_946_849_179
N = 50
k = np.arange(N)


def scan(truth, sensor, stamp, fields, columns, points, intensities, times, tail=b""):
    truth.bytes(f"Town/LiDAR/{sensor}/{stamp}.bin", packed(XYZ + fields, [*points.T, *columns]) + tail)
    truth.scan(stamp, "unknown|start", "no|unknown", "recorded", points, intensities, times)


def ouster(truth, stamp):
    ns = k * 2_000_000
    scan(truth, "Ouster", stamp,
         [("intensity", "<f4"), ("t", "<u4"), ("reflectivity", "<u2"), ("ring", "<u2"), ("ambient", "<u2")],
         [k * 11, ns, k + 300, k % 128, k + 900], returns(N, 1), k * 11, ns * 1e-9)


def velodyne(truth, stamp):
    seconds = np.float32(k * 0.002)
    scan(truth, "Velodyne", stamp, [("intensity", "<f4"), ("ring", "<u2"), ("time", "<f4")],
         [k * 2, k % 16, seconds], returns(N, 2), k * 2, seconds, b"\7" * 21)  # a record that was cut


def avia(truth, stamp):
    ns = k * 1_999_999
    scan(truth, "Avia", stamp,
         [("reflectivity", "u1"), ("tag", "u1"), ("line", "u1"), ("offset_time", "<u4")],
         [k * 5, k % 4 * 16, k % 6, ns], returns(N, 3), k * 5, ns * 1e-9)


def aeva(truth, stamp, long_record):
    """58 records of 25 bytes or 50 of 29: files of 1450 bytes both, so that only the stamp tells which."""
    k = np.arange(50 if long_record else 58)
    ns = k * 1_500_000
    fields = [("reflectivity", "<f4"), ("velocity", "<f4"), ("time_offset_ns", "<i4"), ("line_index", "u1")]
    columns = [k * 0.5, k - 20.25, ns, k % 64]
    if long_record:
        fields.append(("intensity", "<f4"))
        columns.append(k * 0.25 + 7)
    # Of the two columns for intensity, reflectivity is in all files.
    scan(truth, "Aeva", stamp, fields, columns, returns(len(k), 4), k * 0.5, ns * 1e-9)


def poses(truth, sensor, stamps):
    rows = [f"{stamp} {10 * i + 0.5} {-i} 0.25 0 0 {0.5 ** 0.5:.12f} {0.5 ** 0.5:.12f}"
            for i, stamp in enumerate(stamps)]
    truth.text(f"Town/LiDAR_GT/global_{sensor}_gt.txt", "\n".join(rows) + "\n")


def main():
    truth = Truth(sys.argv[1])
    start = LAST_SHORT_AEVA
    for sensor, write in (("Ouster", ouster), ("Velodyne", velodyne), ("Avia", avia)):
        truth.log(f"Town/LiDAR/{sensor}", "helipr")
        for stamp in (start, start + 100_000_000):
            write(truth, stamp)
        poses(truth, sensor, (start, start + 100_000_000))
    truth.log("Town/LiDAR/Aeva", "helipr")
    aeva(truth, start, False)
    aeva(truth, start + 100_000_000, True)
    poses(truth, "Aeva", (start, start + 100_000_000))


main()
