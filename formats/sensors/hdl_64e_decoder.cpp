// SPDX-License-Identifier: MIT
// Times and corrections: HDL-64E S2 and S3 user manuals (63-HDL64ES2, 63-9194), appendices on
// firing times and on calibration, as the ROS driver (velodyne_pointcloud) and velodyne_decoder
// have them.
#include "formats/sensors/hdl_64e_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <vector>

#include "formats/clouds/refusal.hpp"
#include "formats/sensors/packet_bytes.hpp"
#include "formats/sensors/past_hour_clock.hpp"
#include "formats/sensors/sweep_builder.hpp"
#include "formats/sensors/velodyne_packet.hpp"

namespace kissmap {
namespace {

constexpr std::int64_t hour_us = 3'600'000'000;
constexpr double ns_per_us = 1000.0;
constexpr double unit_m = 0.002;
constexpr double deg_per_step = 0.01;
constexpr double rad_per_step = deg_per_step * std::numbers::pi / 180.0;
constexpr std::size_t banks = 2;          // fire at the same time
constexpr std::size_t blocks = 12;        // of a packet
constexpr std::size_t most_waiting = 32;  // packets, until the pace is known
constexpr double most_off_pace = 0.05;    // of the time from packet to packet
constexpr double slowest_deg_per_us = 0.0006;
constexpr double fastest_deg_per_us = 0.009;

/// Where the maker measured the corrections of distance at two points [m].
constexpr double near_x = 2.4;
constexpr double near_y = 1.93;
constexpr double far_wall = 25.04;

struct Pace {
  const char* name;
  double column_us;  // of both banks
  double four_us;    // of the four lasers that fire one after the other
  std::array<double, 4> in_four_us;
};
constexpr Pace s2{"Velodyne HDL-64E S2", 48.0, 6.0, {0.0, 1.26, 2.46, 3.66}};
constexpr Pace s3{"Velodyne HDL-64E S3", 57.6, 7.2, {0.0, 1.3, 2.5, 3.7}};
constexpr Pace s1{"Velodyne HDL-64E S1", 48.0, 6.0, {0.0, 1.26, 2.46, 3.66}};

double shot_us(const Pace& pace, std::size_t shot) {
  const std::size_t fours = shot / 4;
  return static_cast<double>(fours) * pace.four_us + pace.in_four_us[shot % 4];
}

double square(double value) {
  return value * value;
}

/// Four blocks of one azimuth are two returns of both banks.
bool is_dual(const PacketBytes& packet) {
  return velodyne_azimuth_steps(packet, 0) == velodyne_azimuth_steps(packet, 2) &&
         velodyne_azimuth_steps(packet, 4) == velodyne_azimuth_steps(packet, 6) &&
         velodyne_azimuth_steps(packet, 0) != velodyne_azimuth_steps(packet, 4);
}

class Hdl64eDecoder final : public PacketDecoder {
 public:
  explicit Hdl64eDecoder(const Hdl64eCalibration& calibration) : calibration_(calibration) {}

  void add(std::span<const std::byte> payload, std::int64_t received_ns) override;
  void finish() override;
  std::string sensor() const override {
    return pace_ == nullptr ? "Velodyne HDL-64E" : pace_->name;
  }

 private:
  /// A packet that waits for the next one, which tells the pace.
  struct Waiting {
    std::vector<std::byte> payload;
    std::int64_t host_ns = 0;
  };

  void pass_incomplete(std::size_t sweeps) override { sweep_.pass(sweeps); }
  const Pace* pace_between(const PacketBytes& first, const PacketBytes& second) const;
  void decode_waiting();
  void decode(const PacketBytes& packet, std::int64_t host_ns);
  void measure_rate(const PacketBytes& packet, std::size_t per_column);
  /// A column of a packet and what was known when it came, as it may be decoded later.
  struct Column {
    std::size_t first_block = 0;
    std::int64_t ns = 0;
    bool dual = false;
    double deg_per_us = 0.0;
    std::size_t blocks() const { return dual ? 2 * banks : banks; }
  };
  void decode_column(const PacketBytes& packet, const Column& column);
  void decode_block(const PacketBytes& packet, std::size_t block, const Column& column);
  static Eigen::Vector3f direction(const Hdl64eLaser& laser, double azimuth);
  Eigen::Vector3f point(const Hdl64eLaser& laser, double range, double azimuth) const;
  float intensity(const Hdl64eLaser& laser, unsigned raw, unsigned distance) const;

  const Hdl64eCalibration calibration_;
  const Pace* pace_ = nullptr;
  std::vector<Waiting> waiting_;
  PastHourClock clock_;
  double deg_per_us_ = 0.0;
  SweepBuilder sweep_{sweeps_};
};

void Hdl64eDecoder::add(std::span<const std::byte> payload, std::int64_t received_ns) {
  const std::int64_t host_ns = placeable(received_ns);
  const PacketBytes packet(payload);
  if (!is_velodyne_packet(packet)) {
    ++counts_.foreign;
    return;
  }
  if (!is_hdl_64e_packet(packet)) {
    if (counts_.decoded == 0 && waiting_.empty()) {
      throw Refusal(refusal_reason::wrong_kind,
                    "packets of another Velodyne than the HDL-64E of the calibration");
    }
    ++counts_.damaged;
    return;
  }
  if (pace_ != nullptr) return decode(packet, host_ns);
  if (!waiting_.empty()) pace_ = pace_between(PacketBytes(waiting_.back().payload), packet);
  waiting_.push_back({{payload.begin(), payload.end()}, host_ns});
  if (pace_ == nullptr && waiting_.size() >= most_waiting) pace_ = &s1;
  if (pace_ != nullptr) decode_waiting();
}

void Hdl64eDecoder::finish() {
  if (pace_ == nullptr && !waiting_.empty()) pace_ = &s1;
  decode_waiting();
  sweep_.finish();
}

// Null where the times in both do not follow each other as those of one sensor.
const Pace* Hdl64eDecoder::pace_between(const PacketBytes& first, const PacketBytes& second) const {
  const std::int64_t before_us = velodyne_us_past_hour(first);
  const std::int64_t now_us = velodyne_us_past_hour(second);
  if (before_us >= hour_us || now_us >= hour_us) return nullptr;
  const auto passed_us = static_cast<double>((now_us - before_us + hour_us) % hour_us);
  const std::size_t columns = blocks / (is_dual(first) ? 2 * banks : banks);
  for (const Pace* pace : {&s2, &s3}) {
    const double expected_us = static_cast<double>(columns) * pace->column_us;
    if (std::abs(passed_us - expected_us) < most_off_pace * expected_us + 1.0) return pace;
  }
  return nullptr;
}

void Hdl64eDecoder::decode_waiting() {
  for (const Waiting& packet : waiting_) decode(PacketBytes(packet.payload), packet.host_ns);
  waiting_.clear();
}

void Hdl64eDecoder::decode(const PacketBytes& packet, std::int64_t host_ns) {
  const std::int64_t past_hour_us = velodyne_us_past_hour(packet);
  if (pace_ != &s1 && past_hour_us >= hour_us) {
    ++counts_.damaged;
    return;
  }
  const std::int64_t packet_ns =
      pace_ == &s1 ? host_ns
                   : clock_.place(past_hour_us, host_ns) * static_cast<std::int64_t>(ns_per_us);
  const bool dual = is_dual(packet);
  const std::size_t per_column = dual ? 2 * banks : banks;
  measure_rate(packet, per_column);
  KeptPacket kept(packet);
  for (std::size_t block = 0; block < blocks; block += per_column) {
    const std::size_t in_packet = block / per_column;
    const double column_us = static_cast<double>(in_packet) * pace_->column_us;
    const std::int64_t column_ns = packet_ns + std::llround(column_us * ns_per_us);
    sweep_.begin_column(velodyne_azimuth_steps(packet, block) * deg_per_step,
                        column_ns,
                        host_ns,
                        per_column * velodyne_shots_per_block);
    const Column column{block, column_ns, dual, deg_per_us_};
    sweep_.decode_column(
        kept, [this, column](const PacketBytes& bytes) { decode_column(bytes, column); });
  }
  ++counts_.decoded;
}

void Hdl64eDecoder::measure_rate(const PacketBytes& packet, std::size_t per_column) {
  const std::size_t last = blocks - per_column;
  const int steps = velodyne_azimuth_steps(packet, last) - velodyne_azimuth_steps(packet, 0);
  const double turned_deg =
      ((steps + velodyne_steps_per_turn) % velodyne_steps_per_turn) * deg_per_step;
  const std::size_t columns = last / per_column;
  const double rate = turned_deg / (static_cast<double>(columns) * pace_->column_us);
  if (rate > slowest_deg_per_us && rate < fastest_deg_per_us) deg_per_us_ = rate;
}

void Hdl64eDecoder::decode_column(const PacketBytes& packet, const Column& column) {
  for (std::size_t i = 0; i < column.blocks(); ++i) {
    decode_block(packet, column.first_block + i, column);
  }
}

void Hdl64eDecoder::decode_block(const PacketBytes& packet,
                                 std::size_t block,
                                 const Column& column) {
  const std::size_t first_laser = block % banks * velodyne_shots_per_block;
  const bool second = column.dual && block % (2 * banks) >= banks;
  const int steps = velodyne_azimuth_steps(packet, block);
  for (std::size_t shot = 0; shot < velodyne_shots_per_block; ++shot) {
    const std::size_t at = velodyne_shot_at(block, shot);
    const std::uint16_t distance = packet.u16(at);
    // The other return of the same shot.
    const bool twice =
        column.dual &&
        packet.u16(velodyne_shot_at(second ? block - banks : block + banks, shot)) == distance;
    if (second && twice) continue;
    if (distance == 0 && column.dual && !twice) continue;
    const Hdl64eLaser& laser = calibration_[first_laser + shot];
    const double us = shot_us(*pace_, shot);
    const double azimuth = (steps + column.deg_per_us * us / deg_per_step) * rad_per_step;
    const std::int64_t time_ns = column.ns + std::llround(us * ns_per_us);
    if (distance == 0) {
      sweep_.add_no_return(direction(laser, azimuth), time_ns);
    } else {
      sweep_.add(point(laser, distance * unit_m, azimuth),
                 intensity(laser, packet.u8(at + 2), distance),
                 time_ns);
    }
  }
}

Eigen::Vector3f Hdl64eDecoder::direction(const Hdl64eLaser& laser, double azimuth) {
  const double turned = azimuth - laser.rotation;
  const double level = std::cos(laser.elevation);
  const Eigen::Vector3d ahead(
      level * std::cos(turned), -level * std::sin(turned), std::sin(laser.elevation));
  return ahead.cast<float>();
}

// The manual's own x points right and its y forward.
Eigen::Vector3f Hdl64eDecoder::point(const Hdl64eLaser& laser, double range, double azimuth) const {
  const double turned = azimuth - laser.rotation;
  const double right = std::sin(turned);
  const double ahead = std::cos(turned);
  const double level = std::cos(laser.elevation);
  const double rise = std::sin(laser.elevation);
  const auto on_the_level = [&](double distance) {
    return distance * level - laser.vertical_offset * rise;
  };
  const double distance = range + laser.distance;
  double distance_x = distance;
  double distance_y = distance;
  if (laser.two_points) {
    const double x = std::abs(on_the_level(distance) * right - laser.horizontal_offset * ahead);
    const double y = std::abs(on_the_level(distance) * ahead + laser.horizontal_offset * right);
    distance_x = range + laser.distance_at_x +
                 (laser.distance - laser.distance_at_x) * (x - near_x) / (far_wall - near_x);
    distance_y = range + laser.distance_at_y +
                 (laser.distance - laser.distance_at_y) * (y - near_y) / (far_wall - near_y);
  }
  const double x = on_the_level(distance_x) * right - laser.horizontal_offset * ahead;
  const double y = on_the_level(distance_y) * ahead + laser.horizontal_offset * right;
  const double z = distance_y * rise + laser.vertical_offset * level;
  return Eigen::Vector3d(y, -x, z).cast<float>();
}

float Hdl64eDecoder::intensity(const Hdl64eLaser& laser, unsigned raw, unsigned distance) const {
  constexpr double focal_scale = 13'100.0;
  constexpr double farthest = 65'535.0;
  const double focal = 256.0 * square(1.0 - laser.focal_distance / focal_scale);
  const double there = 256.0 * square(1.0 - distance / farthest);
  const double corrected = raw + laser.focal_slope * std::abs(focal - there);
  return static_cast<float>(std::clamp(corrected, laser.least_intensity, laser.most_intensity));
}

}  // namespace

std::unique_ptr<PacketDecoder> make_hdl_64e_decoder(const Hdl64eCalibration& calibration) {
  return std::make_unique<Hdl64eDecoder>(calibration);
}

}  // namespace kissmap
