// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kissmap {

/// What the metadata JSON of an Ouster sensor tells of its packets and its optics.
struct OusterMetadata {
  std::string product;             ///< "OS-1-128"
  std::string profile = "LEGACY";  ///< layout of the packets
  std::size_t beams = 0;           ///< pixels of a column
  std::size_t columns_per_packet = 16;
  std::size_t columns_per_frame = 0;
  std::vector<double> altitudes_deg;  ///< by beam
  std::vector<double> azimuths_deg;
  Eigen::Vector3d lidar_from_beam_origin_mm = Eigen::Vector3d::Zero();  ///< at encoder angle 0
  Eigen::Isometry3d sensor_from_lidar_mm = Eigen::Isometry3d::Identity();
  std::optional<std::uint32_t> initialization_id;
  std::optional<std::uint16_t> lidar_port;
};

/// Reads metadata as the sensor's HTTP interface and the public tools write it, flat or nested.
/// `origin` names it in errors. Throws Error(input) naming the key. Layout:
/// ouster-lidar/ouster-sdk, sensor_info.cpp.
OusterMetadata read_ouster_metadata(std::string_view json, const std::filesystem::path& origin);

/// The JSON file that belongs to a capture: of its name, else the one with the longest common
/// beginning of names in the folder. Throws Error(input) if there is none.
std::filesystem::path find_ouster_metadata(const std::filesystem::path& capture);

}  // namespace kissmap
