# SPDX-License-Identifier: MIT
"""nuScenes: write_nuscenes.py FOLDER. Two scenes; the second scan of each is a sweep between samples."""
import json
import sys

import numpy as np

from truth import Truth, packed, returns

FIRST_US = 1_532_402_927_647_951
HALF = 0.5 ** 0.5
FIELDS = [(name, "<f4") for name in ("x", "y", "z", "intensity", "ring")]


def cloud(truth, name, turn):
    points = returns(64, turn)
    k = np.arange(64)
    truth.bytes(name, packed(FIELDS, [*points.T, k * 3, k % 32]))
    return points, k * 3


def table(truth, name, rows):
    truth.text(f"v1.0-mini/{name}.json", json.dumps(rows, indent=0))


def scan_rows(scene, i, name, stamp_us):
    """A LiDAR's record, linked both ways, and a camera's of the same sample, which is not to be taken."""
    def token(j):
        return f"{scene}-lidar-{j}" if 0 <= j < 3 else ""
    shared = {"sample_token": f"{scene}-sample", "ego_pose_token": f"{scene}-ego-{i}", "timestamp": stamp_us,
              "fileformat": "pcd", "is_key_frame": i != 1, "height": 0, "width": 0}
    return [{"token": f"{scene}-camera-{i}", **shared, "calibrated_sensor_token": "mount-camera",
             "filename": f"samples/CAM_FRONT/{scene}{i}.jpg", "prev": "", "next": ""},
            {"token": token(i), **shared, "calibrated_sensor_token": "mount-lidar", "filename": name,
             "prev": token(i - 1), "next": token(i + 1)}]


def main():
    truth = Truth(sys.argv[1])
    data, poses, scenes, samples = [], [], [], []
    for s, scene in enumerate(("scene-0061", "scene-0103")):
        truth.log(".", "nuscenes", scene)
        scenes.append({"token": f"{scene}-t", "log_token": "log", "nbr_samples": 1, "name": scene,
                       "first_sample_token": f"{scene}-sample", "last_sample_token": f"{scene}-sample",
                       "description": "turns { \"left\" } at a [light]"})
        samples.append({"token": f"{scene}-sample", "timestamp": FIRST_US, "prev": "", "next": "",
                        "scene_token": f"{scene}-t"})
        for i in range(3):
            stamp_us = FIRST_US + s * 10**9 + i * 50_000
            folder = "sweeps" if i == 1 else "samples"
            name = f"{folder}/LIDAR_TOP/n015-{scene}__LIDAR_TOP__{stamp_us}.pcd.bin"
            points, intensities = cloud(truth, name, 3 * s + i)
            truth.scan(stamp_us * 1000, "end", "yes", "none|derived", points, intensities)
            data += scan_rows(scene, i, name, stamp_us)
            # The car faces north from the second scan on; w comes first.
            rotation = [1, 0, 0, 0] if i == 0 else [HALF, 0, 0, HALF]
            poses.append({"token": f"{scene}-ego-{i}", "timestamp": stamp_us, "rotation": rotation,
                          "translation": [411.25 + 10 * i, 1180.5, 0.0]})
    table(truth, "sample_data", data[::-1])  # the order of a table says nothing
    table(truth, "ego_pose", poses[::-1])
    table(truth, "scene", scenes)
    table(truth, "sample", samples)
    table(truth, "sensor", [{"token": "camera", "channel": "CAM_FRONT", "modality": "camera"},
                            {"token": "lidar", "channel": "LIDAR_TOP", "modality": "lidar"}])
    # The LiDAR's y points ahead: it is turned by -90 degrees, 1 m ahead of the axle and 1.8 m high.
    table(truth, "calibrated_sensor",
          [{"token": "mount-camera", "sensor_token": "camera", "translation": [1.7, 0, 1.5],
            "rotation": [0.5, -0.5, 0.5, -0.5], "camera_intrinsic": []},
           {"token": "mount-lidar", "sensor_token": "lidar", "translation": [1.0, 0, 1.8],
            "rotation": [HALF, 0, 0, -HALF], "camera_intrinsic": []}])
    table(truth, "log", [{"token": "log", "vehicle": "n015", "location": "singapore-onenorth"}])


main()
