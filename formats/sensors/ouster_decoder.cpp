// SPDX-License-Identifier: MIT
#include "formats/sensors/ouster_decoder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "formats/sensors/ouster_packet.hpp"

namespace kissmap {
namespace {

constexpr double radian = std::numbers::pi / 180.0;
constexpr double day_ns = 86'400e9;
constexpr std::int64_t longest_frame_ns = 2'000'000'000;

/// From range and column to a point: Ouster's user manual, "Lidar Range to XYZ".
class OusterOptics {
 public:
  explicit OusterOptics(const OusterMetadata& about)
      : columns_(about.columns_per_frame),
        origin_(about.lidar_from_beam_origin_mm),
        sensor_from_lidar_(about.sensor_from_lidar_mm),
        origin_distance_(std::hypot(origin_.x(), origin_.z())) {
    for (std::size_t i = 0; i < about.beams; ++i) {
      const double azimuth = -about.azimuths_deg[i] * radian;
      const double altitude = about.altitudes_deg[i] * radian;
      beams_.push_back(
          {std::cos(azimuth), std::sin(azimuth), std::cos(altitude), std::sin(altitude)});
    }
  }

  Eigen::Vector3f point(std::size_t beam, std::size_t column, std::uint32_t range_mm) const {
    const double turned = turned_at(column);
    const double c = std::cos(turned);
    const double s = std::sin(turned);
    const auto& [ca, sa, cp, sp] = beams_[beam];
    const double r = static_cast<double>(range_mm) - origin_distance_;
    const Eigen::Vector3d lidar(r * (c * ca - s * sa) * cp + origin_.x() * c,
                                r * (s * ca + c * sa) * cp + origin_.x() * s,
                                r * sp + origin_.z());
    return (1e-3 * (sensor_from_lidar_ * lidar)).cast<float>();
  }

  Eigen::Vector3f direction(std::size_t beam, std::size_t column) const {
    const double turned = turned_at(column);
    const double c = std::cos(turned);
    const double s = std::sin(turned);
    const auto& [ca, sa, cp, sp] = beams_[beam];
    const Eigen::Vector3d lidar((c * ca - s * sa) * cp, (s * ca + c * sa) * cp, sp);
    return (sensor_from_lidar_.linear() * lidar).normalized().cast<float>();
  }

 private:
  double turned_at(std::size_t column) const {
    return 2.0 * std::numbers::pi *
           (1.0 - static_cast<double>(column) / static_cast<double>(columns_));
  }

  std::size_t columns_;
  Eigen::Vector3d origin_;
  Eigen::Isometry3d sensor_from_lidar_;
  double origin_distance_;
  std::vector<std::array<double, 4>> beams_;
};

/// Columns of one frame as they come.
struct Frame {
  std::uint16_t id = 0;
  std::int64_t host_ns = 0;
  std::vector<std::uint64_t> timestamps_ns;  ///< by column
  std::vector<bool> there;
  std::vector<std::byte> pixels;  ///< column by column
};

class OusterDecoder : public PacketDecoder {
 public:
  explicit OusterDecoder(const OusterMetadata& about)
      : about_(about), packets_(about), optics_(about) {}

  void add(std::span<const std::byte> payload, std::int64_t host_ns) override {
    // A driver may pass on a byte more than the packet.
    const std::size_t size = packets_.packet_bytes();
    if (payload.size() != size && payload.size() != size + 1) {
      ++counts_.foreign;
      return;
    }
    const auto packet = payload.first(size);
    const auto session = packets_.initialization_id(packet);
    if (session && about_.initialization_id &&
        *session != (*about_.initialization_id & 0xFFFFFFU)) {
      ++counts_.foreign;
      return;
    }
    ++counts_.decoded;
    for (std::size_t i = 0; i < about_.columns_per_packet; ++i) {
      const OusterColumn column = packets_.column(packet, i);
      if (!column.valid) continue;
      if (column.measurement_id >= about_.columns_per_frame) {
        ++counts_.damaged;
        continue;
      }
      put(column, frame_of(column.frame_id, host_ns));
    }
  }

  void finish() override {
    for (Frame& frame : frames_) emit(frame);
    frames_.clear();
  }

  std::string sensor() const override { return "Ouster " + about_.product; }

 private:
  void pass_incomplete(std::size_t sweeps) override { to_pass_ = sweeps; }

  // The last two frames are open.
  Frame& frame_of(std::uint16_t id, std::int64_t host_ns) {
    for (Frame& frame : frames_) {
      if (frame.id == id) return frame;
    }
    if (frames_.size() == 2) {
      emit(frames_.front());
      frames_.erase(frames_.begin());
    }
    Frame frame;
    frame.id = id;
    frame.host_ns = host_ns;
    frame.timestamps_ns.resize(about_.columns_per_frame);
    frame.there.resize(about_.columns_per_frame);
    frame.pixels.resize(about_.columns_per_frame * column_size());
    frames_.push_back(std::move(frame));
    return frames_.back();
  }

  std::size_t column_size() const { return about_.beams * packets_.profile().pixel_bytes; }

  void put(const OusterColumn& column, Frame& frame) {
    if (frame.there[column.measurement_id]) return;
    frame.there[column.measurement_id] = true;
    frame.timestamps_ns[column.measurement_id] = column.timestamp_ns;
    std::ranges::copy(
        column.pixels,
        frame.pixels.begin() + static_cast<std::ptrdiff_t>(column.measurement_id * column_size()));
  }

  /// The earliest time of the frame; nothing of an empty one.
  std::optional<std::uint64_t> first_time(const Frame& frame) const {
    std::optional<std::uint64_t> first;
    for (std::size_t c = 0; c < frame.there.size(); ++c) {
      if (frame.there[c])
        first = std::min(first.value_or(frame.timestamps_ns[c]), frame.timestamps_ns[c]);
    }
    return first;
  }

  void emit(const Frame& frame) {
    const auto first = first_time(frame);
    if (!first) return;
    Scan scan;
    const auto sensor_ns = static_cast<std::int64_t>(*first);
    const double apart_ns = static_cast<double>(sensor_ns) - static_cast<double>(frame.host_ns);
    const bool one_clock = std::abs(apart_ns) < day_ns;
    scan.stamp_ns = one_clock ? sensor_ns : frame.host_ns;
    scan.stamp_instant = StampInstant::sweep_start;
    scan.compensation = Compensation::no;
    for (std::size_t c = 0; c < frame.there.size(); ++c) {
      if (!frame.there[c]) continue;
      const std::uint64_t passed = frame.timestamps_ns[c] - *first;
      if (passed > static_cast<std::uint64_t>(longest_frame_ns)) {
        ++counts_.damaged;
        continue;
      }
      // One point tells that there is a sweep, and more of it is not wanted.
      if (to_pass_ > 0 && !scan.points.empty()) continue;
      add_column(frame, c, static_cast<float>(static_cast<double>(passed) * 1e-9), scan);
    }
    if (scan.points.empty()) return;
    scan.time_source = TimeSource::recorded;
    sweeps_.push_back(std::move(scan));
    if (to_pass_ > 0) --to_pass_;
  }

  void add_column(const Frame& frame, std::size_t column, float time, Scan& scan) {
    const OusterProfile& profile = packets_.profile();
    for (std::size_t beam = 0; beam < about_.beams; ++beam) {
      const auto pixel =
          std::span(frame.pixels)
              .subspan(column * column_size() + beam * profile.pixel_bytes, profile.pixel_bytes);
      std::uint64_t before = 0;
      bool returned = false;
      for (std::size_t k = 0; k < 2 && profile.range[k].width > 0; ++k) {
        const std::uint64_t steps = OusterPackets::read(pixel, profile.range[k]);
        returned |= steps != 0;
        if (steps == 0 || steps == before) continue;
        before = steps;
        const auto range_mm = static_cast<std::uint32_t>(steps) * profile.range_step_mm;
        const Eigen::Vector3f point = optics_.point(beam, column, range_mm);
        if (point.isZero(0.0F)) continue;
        const OusterField field =
            profile.signal[k].width > 0 ? profile.signal[k] : profile.reflectivity[k];
        scan.points.push_back(point);
        scan.intensities.push_back(static_cast<float>(OusterPackets::read(pixel, field)));
        scan.time_offsets.push_back(time);
      }
      if (returned) continue;
      const Eigen::Vector3f direction = optics_.direction(beam, column);
      if (!direction.allFinite()) continue;  // the transform comes with the metadata
      scan.no_return_directions.push_back(direction);
      scan.no_return_time_offsets.push_back(time);
    }
  }

  OusterMetadata about_;
  OusterPackets packets_;
  OusterOptics optics_;
  std::vector<Frame> frames_;
  std::size_t to_pass_ = 0;
};

}  // namespace

std::unique_ptr<PacketDecoder> make_ouster_decoder(const OusterMetadata& about) {
  return std::make_unique<OusterDecoder>(about);
}

}  // namespace kissmap
