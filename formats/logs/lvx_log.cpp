// SPDX-License-Identifier: MIT
// Livox Viewer's LVX files, versions 1.0 and 1.1: frames of packets of one or several Livox
// sensors. Layout: Livox-SDK/livox_ros_driver, lvx_file.h; data types: Livox SDK communication
// protocol.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/byte_cursor.hpp"
#include "formats/containers/container_file.hpp"
#include "formats/files/input_file.hpp"
#include "formats/logs/logs.hpp"
#include "formats/logs/lvx_times.hpp"
#include "formats/text/lines.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using Bytes = std::span<const std::byte>;

constexpr std::string_view signature = "livox_tech";
constexpr std::uint32_t header_magic = 0xAC0EA767;
constexpr std::size_t public_header = 24;                       // bytes
constexpr std::uint64_t most_frame_bytes = 64 << 20;            // no frame is larger
constexpr std::uint64_t latest_ns = 4'000'000'000'000'000'000;  // later is damage
constexpr std::int64_t scan_ns = 100'000'000;  // frames are joined to scans of this length

/// How packets of one data type hold their points.
struct PacketType {
  std::uint8_t number = 0;
  std::size_t shots = 0;  ///< in a packet
  std::size_t bytes = 0;  ///< of a shot
  std::size_t returns = 0;
  double shot_ns = 0.0;  ///< from shot to shot
  bool spherical = false;
};

constexpr std::array types{PacketType{0, 100, 13, 1, 10'000.0, false},
                           PacketType{1, 100, 9, 1, 10'000.0, true},
                           PacketType{2, 96, 14, 1, 1e9 / 240'000, false},
                           PacketType{4, 48, 28, 2, 1e9 / 240'000, false},
                           PacketType{7, 30, 42, 3, 1e9 / 240'000, false}};
constexpr std::uint8_t inertial_type = 6;
constexpr std::size_t inertial_bytes = 24;

struct Device {
  Eigen::Isometry3d base_from_sensor = Eigen::Isometry3d::Identity();
};

Device read_device(ByteCursor& cursor, bool first_version) {
  constexpr double degree = std::numbers::pi / 180.0;
  cursor.take(16 + 16 + 1 + 1);  // codes, index, type
  const bool enabled = first_version || cursor.value<std::uint8_t>() != 0;
  double values[6];
  for (double& value : values) value = cursor.value<float>();
  Device device;
  if (!enabled) return device;
  device.base_from_sensor.linear() =
      (Eigen::AngleAxisd(values[2] * degree, Eigen::Vector3d::UnitZ()) *
       Eigen::AngleAxisd(values[1] * degree, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(values[0] * degree, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  device.base_from_sensor.translation() = Eigen::Vector3d(values[3], values[4], values[5]);
  if (!device.base_from_sensor.matrix().allFinite()) return {};
  return device;
}

/// A return in the sensor's frame [m]; of a shot without one, zero.
std::pair<Eigen::Vector3d, float> read_return(ByteCursor& cursor, const PacketType& type) {
  Eigen::Vector3d point;
  if (type.spherical) {
    const double range = 1e-3 * cursor.value<std::uint32_t>();
    const double zenith = 0.01 * cursor.value<std::uint16_t>() * std::numbers::pi / 180.0;
    const double azimuth = 0.01 * cursor.value<std::uint16_t>() * std::numbers::pi / 180.0;
    point = range * Eigen::Vector3d(std::sin(zenith) * std::cos(azimuth),
                                    std::sin(zenith) * std::sin(azimuth),
                                    std::cos(zenith));
  } else {
    for (double& coordinate : point) coordinate = 1e-3 * cursor.value<std::int32_t>();
  }
  const auto reflectivity = static_cast<float>(cursor.value<std::uint8_t>());
  const std::size_t tag = type.bytes / type.returns - (type.spherical ? 9 : 13);
  cursor.take(tag);
  return {point, reflectivity};
}

class LvxLog : public ScanLog {
 public:
  explicit LvxLog(const fs::path& path) : file_(path) {
    info_.format = "lvx";
    info_.path = path;
    info_.sensor = "Livox";
    info_.stamp_source = "packets";
    info_.fields = "x f32, y f32, z f32, intensity f32, time f32";
    info_.notes.push_back("frames joined to scans of 0.1 s");
    try {
      read_header();
    } catch (const Refusal& refusal) {
      throw input_error(path, std::string("broken at its beginning: ") + refusal.what());
    }
    info_.time_range = lvx_time_range(file_, frame_offset_, frame_head_bytes());
  }

  const LogInfo& info() const override { return info_; }
  std::vector<LogFile> files() const override { return {file_.log_file()}; }

  std::optional<LogEntry> next() override {
    const std::string name = "scan " + std::to_string(next_index_);
    while (!at_end_ && (points_.empty() || last_ns_ - first_ns_ < scan_ns)) {
      try {
        read_frame();
      } catch (const Refusal& refusal) {
        at_end_ = true;
        damage_ = RefusedScan{refusal.reason(),
                              info_.path.string() + ": at byte " + std::to_string(frame_offset_) +
                                  ": " + refusal.what() + "; what came before is read"};
      }
    }
    if (!points_.empty()) return LogEntry{next_index_++, name, take_scan()};
    if (!damage_) return std::nullopt;
    return LogEntry{next_index_++, info_.path.filename().string(), *std::exchange(damage_, {})};
  }

 private:
  void read_header() {
    ByteCursor cursor(file_.read(0, 64 << 10, buffer_));
    cursor.take(16);
    const auto major = cursor.value<std::uint8_t>();
    const auto minor = cursor.value<std::uint8_t>();
    cursor.take(2);
    if (cursor.value<std::uint32_t>() != header_magic) {
      throw Refusal(refusal_reason::broken_header, "its second mark is missing");
    }
    if (major != 1 || minor > 1) {
      throw Refusal(refusal_reason::unsupported,
                    "LVX " + std::to_string(major) + "." + std::to_string(minor) +
                        "; 1.0 and 1.1 are read. Record a bag, or convert it with Livox Viewer");
    }
    first_version_ = minor == 0;
    if (!first_version_) cursor.value<std::uint32_t>();  // duration of a frame
    const auto count = cursor.value<std::uint8_t>();
    for (int i = 0; i < count; ++i) devices_.push_back(read_device(cursor, first_version_));
    frame_offset_ = cursor.position();
  }

  std::size_t frame_head_bytes() const { return first_version_ ? 32 : 24; }

  void read_frame() {
    const std::size_t head_size = frame_head_bytes();
    const Bytes head = file_.read(frame_offset_, head_size, buffer_);
    if (head.empty()) {
      at_end_ = true;
      return;
    }
    ByteCursor cursor(head);
    const auto current = cursor.value<std::uint64_t>();
    std::uint64_t end = cursor.value<std::uint64_t>();
    cursor.take(head_size - 16);
    if (end == 0) end = file_.size();  // of the last frame
    if (current != frame_offset_ || end < frame_offset_ + head_size ||
        end - frame_offset_ > most_frame_bytes) {
      throw Refusal(refusal_reason::broken_content, "no frame begins here");
    }
    const std::uint64_t size = end - frame_offset_ - head_size;
    const Bytes body = file_.read(frame_offset_ + head_size, size, buffer_);
    const bool cut = body.size() < size;
    read_packets(body);
    frame_offset_ = end;
    if (cut) throw Refusal(refusal_reason::truncated, "the file ends inside of a frame");
  }

  void read_packets(Bytes body) {
    ByteCursor cursor(body);
    while (cursor.left() > 0) {
      const auto device = cursor.value<std::uint8_t>();
      cursor.take(4 + 4 + 1);  // version, port, number, reserved, errors, kind of time
      const auto number = cursor.value<std::uint8_t>();
      const auto time_ns =
          static_cast<std::int64_t>(std::min(cursor.value<std::uint64_t>(), latest_ns));
      if (number == inertial_type) {
        cursor.take(inertial_bytes);
        continue;
      }
      const auto* type = std::ranges::find(types, number, &PacketType::number);
      if (type == types.end()) {
        throw Refusal(refusal_reason::unsupported,
                      "points of Livox data type " + std::to_string(number) + " are not read");
      }
      const Bytes shots = cursor.take(type->shots * type->bytes);
      if (device >= devices_.size()) {
        throw Refusal(refusal_reason::broken_content, "a packet of a sensor that is not described");
      }
      add_packet(*type, devices_[device], time_ns, shots);
    }
  }

  void add_packet(const PacketType& type, const Device& device, std::int64_t time_ns, Bytes shots) {
    ByteCursor cursor(shots);
    if (points_.empty()) first_ns_ = last_ns_ = time_ns;
    for (std::size_t shot = 0; shot < type.shots; ++shot) {
      const auto shot_ns =
          time_ns + static_cast<std::int64_t>(static_cast<double>(shot) * type.shot_ns);
      for (std::size_t k = 0; k < type.returns; ++k) {
        const auto [point, reflectivity] = read_return(cursor, type);
        if (point.isZero()) {
          ++dropped_.zero;
          continue;
        }
        const Eigen::Vector3f placed = (device.base_from_sensor * point).cast<float>();
        if (!(placed.norm() <= max_plausible_range)) {
          ++dropped_.implausible;
          continue;
        }
        points_.push_back(placed);
        intensities_.push_back(reflectivity);
        times_ns_.push_back(shot_ns);
        first_ns_ = std::min(first_ns_, shot_ns);
        last_ns_ = std::max(last_ns_, shot_ns);
      }
    }
  }

  Scan take_scan() {
    constexpr double longest_ns = 2e9;
    Scan scan;
    scan.stamp_ns = first_ns_;
    scan.points = std::exchange(points_, {});
    scan.intensities = std::exchange(intensities_, {});
    scan.dropped = std::exchange(dropped_, {});
    // Clocks that jump, or differ between sensors, tell nothing of the sweep.
    if (static_cast<double>(last_ns_) - static_cast<double>(first_ns_) < longest_ns) {
      scan.time_source = TimeSource::recorded;
      scan.stamp_instant = StampInstant::sweep_start;
      scan.compensation = Compensation::no;
      for (const std::int64_t ns : times_ns_) {
        scan.time_offsets.push_back(static_cast<float>(1e-9 * static_cast<double>(ns - first_ns_)));
      }
    }
    times_ns_.clear();
    return scan;
  }

  ContainerFile file_;
  LogInfo info_;
  std::vector<Device> devices_;
  std::vector<std::byte> buffer_;
  std::uint64_t frame_offset_ = 0;
  std::size_t next_index_ = 0;
  bool first_version_ = false;
  bool at_end_ = false;
  std::optional<RefusedScan> damage_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<float> intensities_;
  std::vector<std::int64_t> times_ns_;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  DroppedReturns dropped_;
};

}  // namespace

bool probe_lvx(const fs::path& path) {
  return text_of(first_bytes(path, public_header)).starts_with(signature);
}

std::unique_ptr<ScanLog> open_lvx(const fs::path& path, const ReadOptions& options) {
  require_valid(options);
  if (!probe_lvx(path)) throw input_error(path, "is no LVX file");
  return std::make_unique<LvxLog>(path);
}

}  // namespace kissmap
