# SPDX-License-Identifier: MIT
"""The odometry metric of the KITTI benchmark, written from the definition in its devkit
(evaluate_odometry.cpp) with matrices instead of quaternions; numpy only. Independent of kissmap.

kitti_metric.py REFERENCE ESTIMATE LENGTH...
prints a line for each length and one for all: LENGTH SEGMENTS TRANSLATION_% ROTATION_DEG_PER_M
"""
import sys

import numpy as np


def read_poses(path):
    rows = np.loadtxt(path).reshape(-1, 3, 4)
    last = np.tile(np.array([[[0.0, 0.0, 0.0, 1.0]]]), (len(rows), 1, 1))
    return np.concatenate([rows, last], axis=1)


def last_frame(distances, first, length):
    for frame in range(first, len(distances)):
        if distances[frame] > distances[first] + length:
            return frame
    return -1


def angle(matrix):
    return np.arccos(np.clip(0.5 * (np.trace(matrix[:3, :3]) - 1.0), -1.0, 1.0))


def segment_errors(reference, estimate, lengths, step=10):
    steps = np.linalg.norm(np.diff(reference[:, :3, 3], axis=0), axis=1)
    distances = np.concatenate([[0.0], np.cumsum(steps)])
    for first in range(0, len(reference), step):
        for length in lengths:
            last = last_frame(distances, first, length)
            if last < 0:
                continue
            true_motion = np.linalg.inv(reference[first]) @ reference[last]
            motion = np.linalg.inv(estimate[first]) @ estimate[last]
            error = np.linalg.inv(motion) @ true_motion
            yield length, np.linalg.norm(error[:3, 3]) / length, angle(error) / length


def main(reference, estimate, *lengths):
    lengths = [float(length) for length in lengths]
    errors = np.array(list(segment_errors(read_poses(reference), read_poses(estimate), lengths)))
    for length in lengths + [0.0]:
        chosen = errors if length == 0.0 else errors[errors[:, 0] == length]
        means = chosen[:, 1:].mean(axis=0) if len(chosen) else np.zeros(2)
        print(length, len(chosen), repr(100.0 * means[0]), repr(np.degrees(means[1])))


if __name__ == "__main__":
    main(*sys.argv[1:])
