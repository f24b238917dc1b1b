// SPDX-License-Identifier: MIT
// Geometry and times of shots: the maker's HesaiLidar_SDK_2.0 (libhesai/UdpParser), without its
// optional correction for the optical centre.
#include "formats/sensors/hesai_decoder.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/sensors/hesai_packet.hpp"
#include "formats/sensors/sweep_builder.hpp"

namespace kissmap {
namespace {

constexpr double deg_per_step = 0.01;
constexpr unsigned steps_per_turn = 36'000;
constexpr double deg_per_us_at_one_rpm = 6e-6;
constexpr double ns_per_us = 1000.0;
constexpr double rad_per_deg = std::numbers::pi / 180.0;

double azimuth_deg_of(const PacketBytes& bytes, const HesaiPacket& packet, std::size_t block) {
  return bytes.u16(packet.block_start(block) + packet.azimuth_at) * deg_per_step;
}

class HesaiDecoder final : public PacketDecoder {
 public:
  explicit HesaiDecoder(HesaiAngles unit) : unit_(std::move(unit)) {}

  void add(std::span<const std::byte> payload, std::int64_t host_ns) override;
  void finish() override { sweep_.finish(); }
  std::string sensor() const override { return model_ == nullptr ? "Hesai" : model_->name; }

 private:
  void pass_incomplete(std::size_t sweeps) override { sweep_.pass(sweeps); }
  const HesaiModel* recognize(const PacketBytes& bytes) const;
  std::optional<HesaiPacket> read(const PacketBytes& bytes, const HesaiModel& model) const;
  double column_us(const HesaiPacket& packet, std::size_t column) const;
  void begin_column(const PacketBytes& bytes,
                    const HesaiPacket& packet,
                    std::size_t column,
                    std::int64_t host_ns);
  void decode_column(const PacketBytes& bytes, const HesaiPacket& packet, std::size_t column);
  bool repeats(const PacketBytes& bytes,
               const HesaiPacket& packet,
               std::size_t block,
               std::size_t shot_at) const;
  bool nothing_returned(const PacketBytes& bytes,
                        const HesaiPacket& packet,
                        std::size_t shot_at) const;
  Eigen::Vector3f point(double range, double azimuth_deg, std::size_t laser) const;
  void use(const HesaiModel& model);

  HesaiAngles unit_;
  const HesaiModel* model_ = nullptr;
  SweepBuilder sweep_{sweeps_};
};

void HesaiDecoder::add(std::span<const std::byte> payload, std::int64_t host_ns) {
  const PacketBytes bytes(payload);
  const HesaiModel* model = recognize(bytes);
  if (model == nullptr) {
    ++counts_.foreign;
    return;
  }
  const std::optional<HesaiPacket> packet = read(bytes, *model);
  if (!packet) {
    ++counts_.damaged;
    return;
  }
  if (model_ == nullptr) use(*model);
  KeptPacket kept(bytes);
  for (std::size_t column = 0; column < model_->blocks / packet->returns; ++column) {
    begin_column(bytes, *packet, column, host_ns);
    sweep_.decode_column(kept, [this, packet = *packet, column](const PacketBytes& there) {
      decode_column(there, packet, column);
    });
  }
  ++counts_.decoded;
}

// Once a sensor is known, packets of others are other traffic on its port.
const HesaiModel* HesaiDecoder::recognize(const PacketBytes& bytes) const {
  if (model_ == nullptr) return recognize_hesai(bytes);
  try {
    return recognize_hesai(bytes) == model_ ? model_ : nullptr;
  } catch (const Refusal&) {
    return nullptr;
  }
}

// Once packets were good, one in a mode that does not exist is damaged.
std::optional<HesaiPacket> HesaiDecoder::read(const PacketBytes& bytes,
                                              const HesaiModel& model) const {
  std::optional<HesaiPacket> packet;
  try {
    packet = read_hesai_packet(bytes, model);
  } catch (const Refusal&) {
    if (model_ == nullptr) throw;
  }
  if (!packet || packet->unit_m == 0.0) return {};
  for (std::size_t block = 0; block < model.blocks; ++block) {
    if (bytes.u16(packet->block_start(block) + packet->azimuth_at) > steps_per_turn) return {};
  }
  return packet;
}

void HesaiDecoder::use(const HesaiModel& model) {
  if (!unit_.empty() && unit_.size() != model.lasers) {
    throw Refusal(refusal_reason::wrong_kind,
                  std::string(model.name) + " has " + std::to_string(model.lasers) +
                      " lasers, and angles were given for " + std::to_string(unit_.size()));
  }
  model_ = &model;
  if (unit_.empty()) unit_.assign(model.angles.begin(), model.angles.end());
}

// After the packet's time.
double HesaiDecoder::column_us(const HesaiPacket& packet, std::size_t column) const {
  const std::size_t last_column = model_->blocks / packet.returns - 1;
  const double columns_after_stamp =
      static_cast<double>(column) -
      (model_->stamp_is_last ? static_cast<double>(last_column) : 0.0);
  return model_->stamped_block_us + columns_after_stamp * model_->column_us;
}

void HesaiDecoder::begin_column(const PacketBytes& bytes,
                                const HesaiPacket& packet,
                                std::size_t column,
                                std::int64_t host_ns) {
  const std::int64_t after_ns = std::llround(column_us(packet, column) * ns_per_us);
  sweep_.begin_column(azimuth_deg_of(bytes, packet, column * packet.returns),
                      packet.time_ns + after_ns,
                      host_ns,
                      packet.returns * model_->lasers);
}

void HesaiDecoder::decode_column(const PacketBytes& bytes,
                                 const HesaiPacket& packet,
                                 std::size_t column) {
  const double begin_us = column_us(packet, column);
  const std::span<const double> firing_us = model_->firing_us[(packet.first_order + column) % 2];
  const double deg_per_us = packet.turns_per_minute * deg_per_us_at_one_rpm;
  const std::size_t first_block = column * packet.returns;
  const double azimuth_deg = azimuth_deg_of(bytes, packet, first_block);
  for (std::size_t block = first_block; block < first_block + packet.returns; ++block) {
    for (std::size_t laser = 0; laser < model_->lasers; ++laser) {
      const std::size_t in_block = packet.azimuth_at + 2 + laser * packet.shot_size;
      const std::size_t at = packet.block_start(block) + in_block;
      const std::uint16_t distance = bytes.u16(at);
      if (repeats(bytes, packet, block, at)) continue;
      if (distance == 0 && (block != first_block || !nothing_returned(bytes, packet, at))) continue;
      const double turned_deg = azimuth_deg + deg_per_us * firing_us[laser];
      const std::int64_t time_ns =
          packet.time_ns + std::llround((begin_us + firing_us[laser]) * ns_per_us);
      if (distance == 0) {
        sweep_.add_no_return(point(1.0, turned_deg, laser), time_ns);
      } else {
        sweep_.add(point(distance * packet.unit_m, turned_deg, laser),
                   static_cast<float>(bytes.u8(at + 2)),
                   time_ns);
      }
    }
  }
}

bool HesaiDecoder::repeats(const PacketBytes& bytes,
                           const HesaiPacket& packet,
                           std::size_t block,
                           std::size_t shot_at) const {
  const std::uint16_t distance = bytes.u16(shot_at);
  for (std::size_t earlier = 1; earlier <= block % packet.returns; ++earlier) {
    if (bytes.u16(shot_at - earlier * packet.block_size) == distance) return true;
  }
  return false;
}

// Of a shot whose place in the first block of its column is given.
bool HesaiDecoder::nothing_returned(const PacketBytes& bytes,
                                    const HesaiPacket& packet,
                                    std::size_t shot_at) const {
  for (std::size_t later = 0; later < packet.returns; ++later) {
    if (bytes.u16(shot_at + later * packet.block_size) != 0) return false;
  }
  return true;
}

Eigen::Vector3f HesaiDecoder::point(double range, double azimuth_deg, std::size_t laser) const {
  const double azimuth = (azimuth_deg + unit_[laser].azimuth_deg) * rad_per_deg;
  const double elevation = unit_[laser].elevation_deg * rad_per_deg;
  const double level = range * std::cos(elevation);
  return Eigen::Vector3d(
             level * std::sin(azimuth), level * std::cos(azimuth), range * std::sin(elevation))
      .cast<float>();
}

}  // namespace

std::unique_ptr<PacketDecoder> make_hesai_decoder(HesaiAngles unit) {
  return std::make_unique<HesaiDecoder>(std::move(unit));
}

}  // namespace kissmap
