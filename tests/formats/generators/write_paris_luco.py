# SPDX-License-Identifier: MIT
"""Paris-Luco of CT-ICP: write_paris_luco.py FOLDER. Frames as PLY with times, positions of the LiDAR."""
import sys

import numpy as np

from truth import Truth, packed, returns

N = 60
k = np.arange(N)


def ply(types, columns):
    words = {"<f4": "float", "<f8": "double"}
    names = ("x", "y", "z", "timestamp")
    head = "ply\nformat binary_little_endian 1.0\n" + f"element vertex {N}\n"
    head += "".join(f"property {words[t]} {name}\n" for name, t in zip(names, types)) + "end_header\n"
    return head.encode() + packed(list(zip(names, types)), columns)


def main():
    truth = Truth(sys.argv[1])
    truth.log("00", "paris-luco")
    for i in range(3):
        points = returns(N, i)
        # Seconds of some clock over a sweep of 0.1 s, shuffled, since rings come one after the other.
        order = k * 7 % N
        types = ["<f4", "<f4", "<f4", "<f8"] if i < 2 else ["<f8"] * 4
        seconds = 1.5e9 + 0.1 * i + order * 0.1 / (N - 1)
        truth.bytes(f"00/frames/frame_{i:05}.ply", ply(types, [*points.T, seconds]))
        truth.scan(i * 100_000_000, "unknown|start", "no|unknown", "recorded", points, None,
                   order / (N - 1) * 0.1)
    truth.text("00/gt_traj_lidar.txt", "0 0 0\n1.5 0.25 0\n3 -0.5 0.125\n")


main()
