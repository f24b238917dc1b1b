// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/mapping/local_map.hpp"
#include "kissmap/mapping/splitting_rule.hpp"
#include "kissmap/odometry/odometry.hpp"
#include "kissmap/parallel/thread_pool.hpp"

namespace kissmap {

/// METHOD section 2.
struct LocalMapOptions {
  double voxel_size = 0.5;            ///< m, of a local map's grid
  int max_points_per_voxel = 20;      ///< of a local map's grid
  double splitting_distance = 100.0;  ///< m from the keypose at which a local map is closed at most
};
/// Throws Error(usage) naming the field, its value and its range.
void require_valid(const LocalMapOptions& options);

/// Why the mapper could not use a scan. The log goes on without it.
enum class ScanRefusal {
  no_points,          ///< none finite and in range
  stamp_repeated,     ///< same stamp as the last scan used
  stamp_out_of_order  ///< earlier than the last scan used
};
/// Short text for reports, the same for the same cause.
const char* to_string(ScanRefusal refusal);

/// What became of one scan.
struct MapperStep {
  std::variant<MappedScan, ScanRefusal> scan;
  std::optional<LocalMap> closed;  ///< the local map this scan completed
};

/// Odometry and local maps: scans in, poses and closed local maps out. The map frame is the lidar
/// frame of the first used scan. Memory holds one open local map, whatever the length of the log.
/// Same result for any number of threads of the pool. Not thread safe.
class Mapper {
 public:
  /// The splitting rule defaults to split_by_range() from 10 m to local_maps.splitting_distance.
  Mapper(const OdometryOptions& odometry,
         const LocalMapOptions& local_maps,
         ThreadPool& pool,
         SplittingRule splitting_rule = {});

  /// Takes the next scan in recorded order.
  MapperStep add(const Scan& scan);

  /// Closes the open local map at the end of the log: empty if no scan belongs to it. However
  /// short, it is marked LocalMapEnd::end_of_log, so that later stages need not take it for a node
  /// of its own. Call once, last.
  std::optional<LocalMap> finish();

 private:
  std::optional<ScanRefusal> check_stamp(const Scan& scan) const;
  MappedScan place(const Scan& scan, const RegisteredScan& registered);
  bool still_opening() const;
  void fill_grids(std::span<const Eigen::Vector3f> points_in_frame);
  LocalMap close(LocalMapEnd end);

  Odometry odometry_;
  SplittingRule splitting_rule_;
  VoxelHashMap grid_;  ///< of the open local map, in its frame
  VoxelHashMap opening_grid_;
  std::uint32_t opening_scans_ = 0;
  double frame_reach_;  ///< m; a local map closed farther away makes odometry restart its frame
  std::vector<Eigen::Vector3f> grid_points_;
  Rigid3 frame_from_local_map_;  ///< frame: that of the odometry
  Rigid3 frame_from_last_;
  std::uint32_t local_map_id_ = 0;
  Rigid3 map_from_local_map_;
  LocalMapProgress progress_;
  double path_length_ = 0.0;                               ///< m, of the open local map
  Eigen::Vector3d last_corner_ = Eigen::Vector3d::Zero();  ///< of the path in steps
  Rigid3 local_map_from_last_;
  std::optional<std::int64_t> last_stamp_;
};

}  // namespace kissmap
