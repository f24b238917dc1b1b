// SPDX-License-Identifier: MIT
#include "formats/products/cast_in_parts.hpp"

#include <algorithm>
#include <string>

#include "kissmap/formats/session_replay.hpp"

namespace kissmap {
namespace {

/// Several maps that are cut as one.
class PartedMaps {
 public:
  PartedMaps(const std::vector<OccupancyMap*>& maps, std::uint64_t max_memory)
      : maps_(maps), max_memory_(max_memory) {}

  /// False when all parts are done.
  bool start_next_part() {
    const std::optional<TileBox> box = boxes_.next();
    if (!box) return false;
    box_ = *box;
    for (OccupancyMap* map : maps_) map->start_over(box_);
    return true;
  }

  /// What is left out is for a later part.
  void bound_memory() {
    std::uint64_t bytes = memory_bytes();
    peak_memory_ = std::max(peak_memory_, bytes);
    for (; bytes > max_memory_; bytes = memory_bytes()) {
      const std::optional<TileBox> kept = boxes_.split(box_, tiles());
      if (!kept) return;
      box_ = *kept;
      for (OccupancyMap* map : maps_) map->restrict_to(box_);
    }
  }

  std::size_t waiting() const { return boxes_.waiting(); }
  std::uint64_t peak_memory() const { return peak_memory_; }

 private:
  std::uint64_t memory_bytes() const {
    std::uint64_t bytes = 0;
    for (const OccupancyMap* map : maps_) bytes += map->memory_bytes();
    return bytes;
  }

  std::vector<Voxel> tiles() const {
    std::vector<Voxel> all;
    for (const OccupancyMap* map : maps_) {
      const std::vector<Voxel> tiles = map->tiles();
      all.insert(all.end(), tiles.begin(), tiles.end());
    }
    return all;
  }

  const std::vector<OccupancyMap*>& maps_;
  std::uint64_t max_memory_;
  TileBoxQueue boxes_;
  TileBox box_;
  std::uint64_t peak_memory_ = 0;
};

std::string label_of(std::uint64_t pass, std::size_t waiting) {
  if (pass + waiting == 1) return "casting rays";
  return "casting rays, pass " + std::to_string(pass) + " of at least " +
         std::to_string(pass + waiting);
}

}  // namespace

CastSummary cast_in_parts(const Session& session,
                          const CastOptions& options,
                          const std::vector<OccupancyMap*>& maps,
                          const ExportProgress& progress,
                          const std::function<void(const PlacedScan&)>& add,
                          const std::function<void()>& on_part) {
  PartedMaps parts(maps, options.max_memory);
  CastSummary summary;
  while (parts.start_next_part()) {
    ++summary.passes;
    SessionReplay replay(session,
                         options.min_range,
                         options.max_range,
                         options.moved_log,
                         1,
                         options.no_returns ? NoReturns::placed : NoReturns::left_out);
    while (const std::optional<PlacedScan> scan = replay.next()) {
      add(*scan);
      if (summary.passes == 1) summary.no_returns += scan->no_return_directions.size();
      parts.bound_memory();
      const std::string label = label_of(summary.passes, parts.waiting());
      progress(label.c_str(), scan->scan_idx + 1, replay.size());
    }
    on_part();
  }
  summary.peak_memory = parts.peak_memory();
  return summary;
}

}  // namespace kissmap
