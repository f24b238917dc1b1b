// SPDX-License-Identifier: MIT
// Mounts of data sets whose ground truth is not the LiDAR's. Sources: the loaders of KISS-ICP
// (Newer College 2020), of PIN-SLAM (2021); oxford_spires_dataset, configs/sensor.yaml; CT-ICP
// (Hilti 2022), hilti-slam-challenge-2023, extrinsics_robot.yaml (inverted here); CT-ICP and
// nclt2ros (NCLT's body_from_velodyne, rpy 0.807, 0.166, -90.703 degrees, turned to z up on both
// sides as the scans and the truth are).
#include <array>
#include <stdexcept>

#include "formats/text/lines.hpp"
#include "formats/trajectories/pose_fields.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/trajectory_file.hpp"

namespace kissmap {
namespace {

struct Mount {
  const char* name;
  double x, y, z;         // m
  double qx, qy, qz, qw;  // brought to unit length
};
constexpr std::array<Mount, 6> mounts{{
    // In the left camera.
    {"newer-college-2020", -0.084, -0.025, 0.05, 0.0, 0.0, 0.924, 0.383},
    // In the base.
    {"newer-college-2021", 0.001, 0.0, 0.091, 0.0, 0.0, 0.0, 1.0},
    {"oxford-spires", 0.0, 0.0, 0.124, 0.0, 0.0, 1.0, 0.0},
    // In the IMU.
    {"hilti-2022", -0.001, -0.00855, 0.055, 0.7071068, -0.7071068, 0.0, 0.0},
    {"hilti-2023-robot", 0.133723, -0.0113, 0.010894, 0.999836, -0.001775, 0.017505, 0.004306},
    // In the body.
    {"nclt-hits", 0.002, 0.004, 0.957, 0.00597961, 0.00399214, 0.71142021, 0.70273010},
}};

}  // namespace

Rigid3 mount_from(const std::string& text) {
  for (const Mount& mount : mounts) {
    if (text != mount.name) continue;
    const Eigen::Quaterniond rotation(mount.qw, mount.qx, mount.qy, mount.qz);
    return {rotation.normalized(), {mount.x, mount.y, mount.z}};
  }
  try {
    const Fields fields = split_at_commas(text);
    require_columns(fields, 7, 7);
    const Eigen::Quaterniond rotation(
        number(fields[6]), number(fields[3]), number(fields[4]), number(fields[5]));
    return {unit_quaternion(rotation), position(fields)};
  } catch (const std::invalid_argument& problem) {
    std::string names;
    for (const Mount& mount : mounts) names += std::string(", ") + mount.name;
    throw usage_error("--mount " + in_quotes(text) + ": " + problem.what() +
                      "; wanted are x,y,z,qx,qy,qz,qw or one of" + names.substr(1));
  }
}

}  // namespace kissmap
