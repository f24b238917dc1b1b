# SPDX-License-Identifier: MIT
"""NCLT: write_nclt.py FOLDER. velodyne_sync, the stream velodyne_hits.bin and the ground truth."""
import struct
import sys

import numpy as np

from truth import Truth, packed, returns

FIELDS = [("x", "<u2"), ("y", "<u2"), ("z", "<u2"), ("intensity", "u1"), ("laser", "u1")]
FIRST_US = 1_326_030_975_726_043


def records(points, intensities):
    """Coordinates in steps of 5 mm from -100 m; what the steps leave of the points is returned, too."""
    steps = np.round((points.astype(float) + 100) / 0.005).astype(int)
    k = np.arange(len(points))
    return packed(FIELDS, [*steps.T, intensities, k % 32]), steps * 0.005 - 100


def to_z_up(points):
    return points * (1, -1, -1)


def sync(truth):
    truth.log("2012-01-08", "nclt")
    for i in range(2):
        points = returns(60, i)
        points[:4] = [(63.84, 0.5, 1), (227.675, -99.9, 2), (-100, 3, 1), (0, 150, -2.5)]
        intensities = np.arange(60) * 4
        data, exact = records(points, intensities)
        stamp_us = FIRST_US + i * 199_999
        truth.bytes(f"2012-01-08/velodyne_sync/{stamp_us}.bin", data)
        truth.scan(stamp_us * 1000, "unknown|start|middle|end", "yes", "none", to_z_up(exact), intensities)


def hits(truth):
    """Two and a half turns, 40 degrees and 24 hits a packet, with bytes of no packet in between."""
    truth.log("2012-01-08_vel/2012-01-08/velodyne_hits.bin", "nclt-hits")
    stream, kept, strengths, times = b"", [], [], []
    for packet in range(23):
        # Clockwise from above: with z down, angles from x to y grow. No hit lies on the axes.
        angle = np.radians(1 + 40 * packet + np.arange(24) * 40 / 24)
        points = np.stack([20 * np.cos(angle), 20 * np.sin(angle), np.arange(24) % 5 - 1.5], 1)
        data, exact = records(points, np.arange(24) + packet)
        since_start_us = packet * 11_111
        stream += struct.pack("<4HIQI", 44444, 44444, 44444, 44444, 24, FIRST_US + since_start_us, 0) + data
        if packet in (4, 13):
            stream += b"\x9c\xad\x9c\xad\x00\x01\x02"  # half a mark, then other bytes
        kept.append(to_z_up(exact))
        strengths.append(np.arange(24) + packet)
        times.append(np.full(24, since_start_us * 1e-6))
    truth.bytes("2012-01-08_vel/2012-01-08/velodyne_hits.bin", stream)
    truth.stream(FIRST_US * 1000, "unknown|start|middle|end", "no", "recorded|derived", np.concatenate(kept),
                 np.concatenate(strengths), np.concatenate(times))
    truth.refused()  # the bytes of no packet, told at the end


def ground_truth(truth):
    rows = ["%d,nan,nan,nan,nan,nan,nan" % (FIRST_US - 20_000),
            "%d,1,2,3,0,0,0" % FIRST_US,
            "%d,4,2,3,1.5707963267949,0,1.5707963267949" % (FIRST_US + 199_999)]
    truth.text("ground_truth/groundtruth_2012-01-08.csv", "\n".join(rows) + "\n")


truth = Truth(sys.argv[1])
sync(truth)
hits(truth)
ground_truth(truth)
