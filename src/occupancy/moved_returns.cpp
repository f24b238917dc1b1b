// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/moved_returns.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <utility>
#include <vector>

#include "kissmap/occupancy/grazing_margin.hpp"
#include "occupancy/scan_rays.hpp"
#include "occupancy/sightings.hpp"
#include "options.hpp"

namespace kissmap {

using occupancy::Sighting;
using occupancy::Sightings;

class MovedReturns::Impl {
 public:
  explicit Impl(const MovedReturnsOptions& options)
      : options_(options),
        sightings_(
            (require_between("voxel size", options.voxel_size, 0.01, 10.0), options.voxel_size)) {
    require_between("passages per hit", options.passages_per_hit, 0.0, 1000.0);
    require_between("seconds together", options.seconds_together, 0.0, 60.0);
  }

  void add_returns(const PlacedScan& scan) {
    sightings_.add_returns(occupancy::rays_of(scan, scan.map_from_lidar, 0.0).view());
  }

  void add_rays(const PlacedScan& scan, ThreadPool& pool) {
    if (!settled_) sightings_.settle(pool);
    settled_ = true;
    occupancy::ScanRays rays = occupancy::rays_of(scan, scan.map_from_lidar, 0.0);
    rays.margins = grazing_margins(rays.view(), sightings_.geometry().voxel_size, grazing, pool);
    const double seconds =
        1e-9 * (static_cast<double>(scan.pose_stamp_ns) - static_cast<double>(batch_begin_ns_));
    if (std::abs(seconds) > options_.seconds_together || batch_.size() >= most_together) {
      cast_batch(pool);
    }
    if (batch_.empty()) batch_begin_ns_ = scan.pose_stamp_ns;
    batch_.push_back(std::move(rays));
  }

  void decide(ThreadPool& pool) {
    cast_batch(pool);
    std::atomic<std::size_t> all = 0;
    sightings_.for_each(pool, [&](const Voxel& voxel, Sighting& sighting) {
      sighting.passed = is_passed(voxel, sighting);
      ++all;
    });
    voxels_ = all;
    std::mutex mutex;
    std::vector<Voxel> starts;
    sightings_.for_each(pool, [&](const Voxel& voxel, Sighting& sighting) {
      const Surroundings around = surroundings(voxel);
      sighting.in_group =
          sighting.passed && around.passed >= std::min(most_wanted, 0.5 * around.seen);
      if (!sighting.in_group) return;
      const std::lock_guard lock(mutex);
      starts.push_back(voxel);
    });
    moved_voxels_ = 0;
    for (const Voxel& start : starts) decide_group(start);
  }

  bool moved(const Eigen::Vector3d& place) const {
    const std::optional<Voxel> voxel = voxel_at(sightings_.geometry(), place);
    const Sighting* sighting = voxel ? sightings_.at(*voxel) : nullptr;
    return sighting != nullptr && sighting->moved;
  }

  std::size_t voxels() const { return voxels_; }
  std::size_t moved_voxels() const { return moved_voxels_; }

 private:
  static constexpr GrazingOptions grazing{0.1, 0.03};

  static constexpr std::size_t most_together = 100;
  static constexpr double own_weight = 8.0;  // beside the 27 voxels around, itself among them
  static constexpr double most_wanted =
      8.0;  // voxels passed around one in a group, or half of them
  static constexpr std::size_t large_group = 100;
  static constexpr double edge_passages_per_hit = 0.3;
  static constexpr double most_standing = 0.15;  // of the voxels around a group that is alone

  void cast_batch(ThreadPool& pool) {
    std::vector<RayScan> views;
    for (const occupancy::ScanRays& rays : batch_) views.push_back(rays.view());
    sightings_.add_rays(views, pool);
    batch_.clear();
  }

  /// A voxel and its 26 neighbours, those with returns.
  template <class Visit>
  void for_each_around(const Voxel& voxel, Visit&& visit) const {
    for (std::int32_t z = -1; z <= 1; ++z) {
      for (std::int32_t y = -1; y <= 1; ++y) {
        for (std::int32_t x = -1; x <= 1; ++x) {
          const Voxel place{voxel.x + x, voxel.y + y, voxel.z + z};
          if (const Sighting* near = sightings_.at(place)) visit(place, *near);
        }
      }
    }
  }

  bool is_passed(const Voxel& voxel, const Sighting& sighting) const {
    double hits = own_weight * sighting.hits;
    double passages = own_weight * sighting.passages;
    for_each_around(voxel, [&](const Voxel&, const Sighting& near) {
      hits += near.hits;
      passages += near.passages;
    });
    return passages > options_.passages_per_hit * hits;
  }

  struct Surroundings {
    double seen = 0.0;  ///< voxels with returns, itself included
    double passed = 0.0;
  };
  Surroundings surroundings(const Voxel& voxel) const {
    Surroundings around;
    for_each_around(voxel, [&](const Voxel&, const Sighting& near) {
      around.seen += 1.0;
      around.passed += near.passed ? 1.0 : 0.0;
    });
    return around;
  }

  /// The voxels of a group that was not decided yet, taken out of it.
  std::vector<Voxel> take_group(const Voxel& start) {
    std::vector<Voxel> group;
    const auto take = [&](const Voxel& voxel) {
      Sighting* sighting = sightings_.at(voxel);
      if (sighting == nullptr || !sighting->in_group) return;
      sighting->in_group = false;
      group.push_back(voxel);
    };
    take(start);
    for (std::size_t i = 0; i < group.size(); ++i) {
      const Voxel voxel = group[i];
      for_each_around(voxel, [&](const Voxel& near, const Sighting&) { take(near); });
    }
    return group;
  }

  /// What is small and part of what stands, as the edge of a desk, has not moved.
  void decide_group(const Voxel& start) {
    const std::vector<Voxel> group = take_group(start);
    Surroundings all;
    for (const Voxel& voxel : group) {
      const Surroundings around = surroundings(voxel);
      all.seen += around.seen;
      all.passed += around.passed;
    }
    const bool alone = all.seen - all.passed <= most_standing * all.seen;
    if (group.size() < large_group && !alone) return;
    for (const Voxel& voxel : group) sightings_.at(voxel)->moved = true;
    moved_voxels_ += group.size();
    for (const Voxel& voxel : group) take_edge(voxel);
  }

  /// Beside what moved, a voxel's own passages tell: those around it are of what passed there.
  void take_edge(const Voxel& moved) {
    for_each_around(moved, [this](const Voxel& voxel, const Sighting& near) {
      if (near.moved || near.passages <= edge_passages_per_hit * near.hits) return;
      sightings_.at(voxel)->moved = true;
      ++moved_voxels_;
    });
  }

  MovedReturnsOptions options_;
  Sightings sightings_;
  std::vector<occupancy::ScanRays> batch_;  ///< scans that are cast together
  std::int64_t batch_begin_ns_ = 0;
  bool settled_ = false;
  std::size_t voxels_ = 0;
  std::size_t moved_voxels_ = 0;
};

MovedReturns::MovedReturns(const MovedReturnsOptions& options)
    : impl_(std::make_unique<Impl>(options)) {
}

MovedReturns::~MovedReturns() = default;

void MovedReturns::add_returns(const PlacedScan& scan) {
  impl_->add_returns(scan);
}

void MovedReturns::add_rays(const PlacedScan& scan, ThreadPool& pool) {
  impl_->add_rays(scan, pool);
}

void MovedReturns::decide(ThreadPool& pool) {
  impl_->decide(pool);
}

bool MovedReturns::moved(const Eigen::Vector3d& place) const {
  return impl_->moved(place);
}

std::size_t MovedReturns::voxels() const {
  return impl_->voxels();
}

std::size_t MovedReturns::moved_voxels() const {
  return impl_->moved_voxels();
}

}  // namespace kissmap
