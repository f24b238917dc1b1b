// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// Surface elements: one mean and one normal for each voxel with at least 3 points.
struct SurfelCloud {
  std::vector<Eigen::Vector3f> means;    ///< m
  std::vector<Eigen::Vector3f> normals;  ///< unit length, sign towards the local map's keypose

  std::size_t size() const { return means.size(); }
};

/// Why a local map was closed: the splitting rule asked for it, or the log ended first.
enum class LocalMapEnd : std::uint8_t { split, end_of_log };

/// A closed local map (METHOD section 2). Its keypose is the pose of the last scan before it;
/// the first local map's keypose is the identity.
struct LocalMap {
  std::uint32_t id = 0;                 ///< counts from 0 in the order of recording
  Rigid3 map_from_local_map;            ///< the keypose
  SurfelCloud surfels;                  ///< local_map frame
  std::vector<Eigen::Vector3f> points;  ///< all of its grid, local_map frame [m]; not stored
  /// Surfels of its first few scans alone, a third of a mean range or so: too short a stretch to be
  /// bent by drift. Same frame; not stored.
  SurfelCloud opening;
  std::uint32_t opening_scans = 0;
  std::uint64_t scan_count = 0;  ///< scans whose pose is relative to this keypose
  double path_length = 0.0;      ///< m, sum of the motions between its scans
  double displacement = 0.0;     ///< m, last scan from the keypose
  LocalMapEnd end = LocalMapEnd::split;
};

/// One scan with its place, as the mapper found it.
struct MappedScan {
  std::int64_t stamp_ns = 0;       ///< of the scan, as recorded
  std::int64_t pose_stamp_ns = 0;  ///< instant the pose holds for: sweep end if deskewed
  std::uint32_t local_map_id = 0;
  Rigid3 local_map_from_lidar;
  Rigid3 map_from_lidar;
  bool deskewed = false;
  Rigid3 sweep_start_from_sweep_end;  ///< motion the points were deskewed with, or identity
  std::uint64_t points_read = 0;      ///< usable returns in the scan
  std::uint64_t points_in_range = 0;  ///< of these, between min and max range
  std::uint32_t iterations = 0;       ///< of the registration
  bool converged = true;              ///< the registration's last update was small enough
};

}  // namespace kissmap
