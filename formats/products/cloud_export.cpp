// SPDX-License-Identifier: MIT
#include "kissmap/formats/cloud_export.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>

#include "formats/pictures/height_colour.hpp"
#include "formats/pictures/map_raster.hpp"
#include "formats/products/cloud_frame.hpp"
#include "formats/products/export_target.hpp"
#include "formats/products/offset_file.hpp"
#include "formats/products/removed_cloud.hpp"
#include "formats/products/session_points.hpp"
#include "formats/products/tile_folder.hpp"
#include "formats/session/session_folder.hpp"
#include "kissmap/cloud/outliers.hpp"
#include "kissmap/cloud/thinned_cloud.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t year_2001_ns = 1'000'000'000'000'000'000;

Error nothing_left(const Session& session, const CloudExportOptions& options) {
  const auto from = [](double range) { return std::to_string(range); };
  return usage_error(session.path.string() + ": no point is inside the crop and " +
                     from(options.min_range) + " to " + from(options.max_range) +
                     " m from the sensor; widen --crop, --crop-polygon, --z-min, --z-max");
}

/// One export, from what is asked for to what is written.
class Exporter {
 public:
  Exporter(const Session& session,
           const fs::path& output,
           const CloudExportOptions& options,
           ThreadPool& pool,
           const ExportProgress& progress)
      : session_(session), output_(output), options_(options), pool_(pool), progress_(progress) {}

  CloudExportSummary run() {
    resolve_fields();
    resolve_frame();
    if (options_.remove_dynamic) {
      moved_ = find_moved(session_, options_, pool_, progress_);
      summary_.moved_file = removed_path(output_);
    }
    if (options_.voxel_size > 0.0) {
      write_thinned();
    } else {
      write_all();
    }
    return summary_;
  }

 private:
  void resolve_fields() {
    CloudFields& fields = writer_.fields;
    fields = options_.fields;
    if (options_.intensity_if_there) fields.intensity |= has_intensities(session_, options_);
    if (fields.time && session_.manifest.log.stamp_source == "index") {
      throw usage_error("--fields time: the log of " + session_.path.string() +
                        " has no stamps; leave time out");
    }
    if (fields.rgb) {
      std::vector<Eigen::Vector3d> trajectory;
      for (const SessionScan& scan : session_.scans) {
        trajectory.push_back(scan.mapped.map_from_lidar.translation);
      }
      view_ = choose_view(session_.path, session_.local_maps, trajectory, 1000);
    }
    summary_.fields = fields;
  }

  void resolve_frame() {
    const Eigen::AlignedBox3d reach = reach_of(session_, options_.max_range);
    writes_las_ = options_.tile_size == 0 && cloud_format(output_) == CloudFormat::las;
    writer_.compress = options_.compress;
    writer_.frame = name_of(options_.frame);
    writer_.unix_time =
        !session_.scans.empty() && session_.scans.front().mapped.pose_stamp_ns > year_2001_ns;
    writer_.offset = writes_las_ ? whole_metre_centre(reach) : single_precision_offset(reach);
    if (!writes_las_) summary_.offset = writer_.offset;
  }

  CloudPoint coloured(const MapPoint& point) const {
    CloudPoint result;
    result.point = point;
    if (!writer_.fields.rgb) return result;
    const double share = (point.position.z() - view_.low) / (view_.high - view_.low);
    const Eigen::Array3f colour = height_colour(static_cast<float>(share));
    for (int i = 0; i < 3; ++i) {
      result.rgb[static_cast<std::size_t>(i)] =
          static_cast<std::uint8_t>(std::lround(255.0F * colour[i]));
    }
    return result;
  }

  void note_intensity(const MapPoint& point) {
    if (point.intensity > writer_.most_intensity) writer_.most_intensity = point.intensity;
  }

  void finish(CloudWriter& writer) {
    summary_.offset_file = write_offset_file(output_, summary_.offset);
    writer.finish();
  }

  bool is_moved(const MapPoint& point) const { return moved_ && moved_->moved(point.position); }

  /// The file of what is left out; null if nothing is.
  std::unique_ptr<CloudWriter> open_removed(std::uint64_t most_points) const {
    if (!moved_) return nullptr;
    CloudWriterOptions removed = writer_;
    removed.fields.normals = false;
    removed.most_points = most_points;
    return open_cloud_writer(summary_.moved_file, removed);
  }

  void finish_removed(CloudWriter* removed) {
    if (removed == nullptr) return;
    write_offset_file(summary_.moved_file, writes_las_ ? Eigen::Vector3d::Zero() : writer_.offset);
    removed->finish();
  }

  void write_all() {
    writer_.most_intensity = 0.0F;
    for (const SessionScan& scan : session_.scans) {
      writer_.most_points += scan.mapped.points_read;
    }
    const CloudFields& fields = writer_.fields;
    if (writes_las_ && fields.intensity) {
      for_each_point(
          session_, options_, fields, progress_, [this](const MapPoint& p) { note_intensity(p); });
    }
    const auto writer = open_cloud_writer(output_, writer_);
    const auto removed = open_removed(writer_.most_points);
    for_each_point(session_, options_, fields, progress_, [&](const MapPoint& point) {
      const bool moved = is_moved(point);
      (moved ? removed : writer)->add(coloured(point));
      ++(moved ? summary_.moved_points : summary_.points_written);
    });
    summary_.points_inside = summary_.points_written + summary_.moved_points;
    if (summary_.points_written == 0) throw nothing_left(session_, options_);
    finish_removed(removed.get());
    finish(*writer);
  }

  void write_thinned() {
    ThinnedCloud cloud(options_.voxel_size);
    ThinnedCloud moved(options_.voxel_size);
    for_each_point(session_, options_, writer_.fields, progress_, [&](const MapPoint& point) {
      (is_moved(point) ? moved : cloud).add(point);
    });
    if (cloud.size() == 0) throw nothing_left(session_, options_);
    summary_.moved_points = moved.points_added();
    summary_.points_inside = cloud.points_added() + moved.points_added();
    const std::vector<std::uint32_t> kept = choose_points(cloud);
    summary_.outliers = cloud.size() - kept.size();
    summary_.points_written = kept.size();
    std::vector<Eigen::Vector3f> normals;
    if (writer_.fields.normals) {
      progress_("finding normals", 0, cloud.size());
      normals = cloud.normals(pool_);
    }
    writer_.most_points = kept.size();
    writer_.most_intensity = 0.0F;
    for (const std::uint32_t i : kept) note_intensity(cloud[i]);
    for (std::size_t i = 0; i < moved.size(); ++i) note_intensity(moved[i]);
    const auto removed = open_removed(moved.size());
    for (std::size_t i = 0; i < moved.size(); ++i) removed->add(coloured(moved[i]));
    finish_removed(removed.get());
    write(kept.size(), [&](std::uint64_t k) {
      CloudPoint point = coloured(cloud[kept[k]]);
      if (!normals.empty()) point.normal = normals[kept[k]];
      return point;
    });
  }

  std::vector<std::uint32_t> choose_points(const ThinnedCloud& cloud) const {
    std::vector<std::uint32_t> all(cloud.size());
    std::iota(all.begin(), all.end(), 0U);
    if (!options_.remove_outliers) return all;
    progress_("looking for outliers", 0, cloud.size());
    const Eigen::Vector3d centre = cloud[0].position;
    std::vector<Eigen::Vector3f> points;
    points.reserve(cloud.size());
    for (const std::uint32_t i : all) {
      points.push_back((cloud[i].position - centre).cast<float>());
    }
    return find_inliers(points);
  }

  void write(std::uint64_t size, const std::function<CloudPoint(std::uint64_t)>& point) {
    progress_("writing points", 0, size);
    if (options_.tile_size > 0) {
      summary_.tiles = write_tile_folder(
          output_, {size, point}, options_.tile_size, writer_, options_.overwrite);
      if (!summary_.offset.isZero(0.0)) summary_.offset_file = output_ / "offset.txt";
      return;
    }
    const auto writer = open_cloud_writer(output_, writer_);
    for (std::uint64_t i = 0; i < size; ++i) writer->add(point(i));
    finish(*writer);
  }

  const Session& session_;
  fs::path output_;
  const CloudExportOptions& options_;
  ThreadPool& pool_;
  const ExportProgress& progress_;
  CloudWriterOptions writer_;
  bool writes_las_ = false;
  std::unique_ptr<MovedReturns> moved_;  ///< null where everything stays
  MapView view_;                         ///< heights of the ends of the colours
  CloudExportSummary summary_;
};

}  // namespace

CloudExportSummary export_cloud(const Session& session,
                                const std::filesystem::path& output,
                                const CloudExportOptions& options,
                                ThreadPool& pool,
                                const ExportProgress& progress) {
  const fs::path target = folder_path(output);  // "tiles/" is "tiles"
  require_options(target, options);
  require_target(target, options);
  if (options.remove_dynamic) require_file_target(removed_path(target), options.overwrite);
  const Rigid3 product_from_map = frame_from_map(session, options.frame);
  const Session placed = moved(session, product_from_map);
  CloudExportSummary summary = Exporter(placed, target, options, pool, progress).run();
  summary.frame_from_map = product_from_map;
  return summary;
}

}  // namespace kissmap
