// SPDX-License-Identifier: MIT
// LAS 1.2 and 1.4 (ASPRS, LAS Specification 1.4 R15), point formats 0 to 3.
#include <cmath>
#include <limits>

#include "formats/clouds/las_header.hpp"
#include "formats/clouds/point_columns.hpp"
#include "formats/files/aside_file.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr char only_return = 0x09;  // 1 of 1
constexpr char unclassified = 1;
constexpr double gps_epoch = 315'964'800.0;  // 1980-01-06 in UNIX seconds
constexpr double leap_seconds = 18.0;        // GPS ahead of UTC, since 2017
constexpr double adjustment = 1e9;           // of "adjusted standard GPS time"

/// Sensors give 0..1, 0..255 or 16 bits; LAS wants the whole of 16 bits.
float intensity_step(float most) {
  if (most <= 1.0F) return 65535.0F;
  return most <= 255.0F ? 257.0F : 1.0F;
}

class LasWriter : public CloudWriter {
 public:
  LasWriter(const std::filesystem::path& path, const CloudWriterOptions& options)
      : options_(options), intensity_step_(intensity_step(options.most_intensity)), file_(path) {
    file_.write(las_header(options_, content_));
  }

  void add(const CloudPoint& point) override {
    const Eigen::Array3i steps = steps_of(point.point.position);
    content_.low = content_.points == 0 ? steps : content_.low.min(steps);
    content_.high = content_.points == 0 ? steps : content_.high.max(steps);
    if (++content_.points > std::max<std::uint64_t>(options_.most_points, most_without_promise)) {
      throw Error(Fault::internal, "more points than promised for " + file_.path().string());
    }
    record_.clear();
    for (const int step : steps) append_value<std::int32_t>(step, record_);
    append_value(options_.fields.intensity ? intensity_of(point.point) : std::uint16_t{0}, record_);
    record_ += {only_return, unclassified, '\0', '\0', '\0', '\0'};  // angle, user, source
    append_fields(point);
    file_.write(record_);
  }

  void finish() override { file_.publish(las_header(options_, content_)); }

 private:
  static constexpr std::uint64_t most_without_promise = std::numeric_limits<std::uint32_t>::max();

  Eigen::Array3i steps_of(const Eigen::Vector3d& position) const {
    if (!position.allFinite()) {
      throw Error(Fault::internal, "a point to be written is not finite");
    }
    const Eigen::Array3d steps = ((position - options_.offset) / las_scale).array().round();
    if (steps.abs().maxCoeff() > std::numeric_limits<std::int32_t>::max()) {
      throw output_error(
          file_.path(),
          "a point is more than 2147 km from the middle of the map, which LAS cannot "
          "hold; look at the trajectory, or crop the map");
    }
    return steps.cast<int>();
  }

  std::uint16_t intensity_of(const MapPoint& point) const {
    const float value = std::round(point.intensity * intensity_step_);
    if (!(value > 0.0F)) return 0;
    return static_cast<std::uint16_t>(std::min(value, 65535.0F));
  }

  double las_time(double time) const {
    return options_.unix_time ? time - gps_epoch + leap_seconds - adjustment : time;
  }

  void append_fields(const CloudPoint& point) {
    if (options_.fields.time) append_value(las_time(point.point.time), record_);
    if (options_.fields.rgb) {
      for (const std::uint8_t channel : point.rgb) {
        append_value(static_cast<std::uint16_t>(257 * channel), record_);
      }
    }
    if (options_.fields.normals) append_vector(point.normal, record_);
    if (options_.fields.scan) append_value(point.point.scan_idx, record_);
    if (options_.fields.sensor) {
      const Eigen::Vector3d sensor = point.point.position + point.point.to_sensor.cast<double>();
      for (const double value : sensor) append_value(value, record_);
    }
  }

  CloudWriterOptions options_;
  float intensity_step_;
  LasContent content_;
  AsideFile file_;
  std::string record_;
};

}  // namespace

std::unique_ptr<CloudWriter> open_las_writer(const std::filesystem::path& path,
                                             const CloudWriterOptions& options) {
  return std::make_unique<LasWriter>(path, options);
}

}  // namespace kissmap
