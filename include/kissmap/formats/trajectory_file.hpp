// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "kissmap/evaluation/trajectory.hpp"

namespace kissmap {

struct TrajectoryFile {
  Trajectory trajectory;
  std::string format;        ///< "session", "TUM", "KITTI", "EuRoC" or a data set's name
  std::size_t repeated = 0;  ///< poses with the stamp of the one before
};

/// Reads a trajectory; its content tells the format:
/// - session: a finished session folder; map_from_lidar at the instants the poses hold for
/// - TUM: stamp [s] tx ty tz [m] qx qy qz qw, spaces between (vision.in.tum.de, RGB-D benchmark)
/// - KITTI: the 12 numbers of [R | t], row by row, without stamps
/// - EuRoC: stamp [ns],tx,ty,tz,qw,qx,qy,qz and any more columns
///   (ASL dataset format, state_groundtruth_estimate0/data.csv)
/// - ground truth as published with MulRan (global_pose.csv, taken to the Ouster by its mount),
///   HeLiPR, Boreas (lidar_poses.csv), NCLT (turned to z up), Newer College and Oxford Spires (of
///   the camera or base they are given for, see mount_from) and Apollo-SouthBay
/// - nuScenes: the folder of the data set or of its tables; map_from_lidar of one scene's scans
/// - positions: x y z [m], or stamp [s] x y z, spaces between, without rotations (control points).
///   Those of Paris-Luco, known by the name gt_traj_lidar.txt, get the stamps of the middles of the
///   frames' sweeps, 0.1 s each, as its reader counts them
/// Blank lines and lines that begin with # are passed over. Rotations are brought to unit length;
/// one that is off by more than a hundredth is an error, as is a stamp before that of the pose
/// before. Poses with the same stamp are kept (published trajectories have such) and counted.
/// `times` names a file with one stamp [s] a line for poses that have none; it is left alone if
/// they have. `topic` names the scene where nuScenes has several. Throws Error(input) naming file,
/// line and cure. Not for files above 2 GiB.
TrajectoryFile read_trajectory(const std::filesystem::path& path,
                               const std::filesystem::path& times = {},
                               const std::string& topic = {});

/// Where the LiDAR sits in the frame whose poses a reference holds, reference_from_lidar, from
/// "x,y,z,qx,qy,qz,qw" [m] or the name of a data set: newer-college-2020, newer-college-2021,
/// oxford-spires, hilti-2022, hilti-2023-robot, nclt-hits. Throws Error(usage).
Rigid3 mount_from(const std::string& text);

/// The pose of the LiDAR in camera 0, cam0_from_lidar, from a calib.txt of KITTI (line "Tr:").
/// The poses of the KITTI benchmark are those of camera 0. Throws Error(input).
Rigid3 read_kitti_calibration(const std::filesystem::path& calib_txt);

}  // namespace kissmap
