# SPDX-License-Identifier: MIT
"""Prints a cloud as Open3D reads it: x y z and, where the file has them, normals, a line a point."""
import sys

import numpy as np
import open3d

cloud = open3d.io.read_point_cloud(sys.argv[1])
columns = [np.asarray(cloud.points)]
if cloud.has_normals():
    columns.append(np.asarray(cloud.normals))
np.savetxt(sys.stdout, np.hstack(columns), fmt="%.9g")
