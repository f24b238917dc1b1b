// SPDX-License-Identifier: MIT
// Layout of packets: the maker's user manuals, the ROS driver (velodyne_pointcloud) and
// velodyne_decoder, which agree.
#include "formats/sensors/velodyne_decoder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>

#include "formats/clouds/refusal.hpp"
#include "formats/sensors/packet_bytes.hpp"
#include "formats/sensors/sweep_builder.hpp"
#include "formats/sensors/velodyne_tables.hpp"

namespace kissmap {
namespace {

constexpr std::size_t packet_size = 1206;
constexpr std::size_t blocks_per_packet = 12;
constexpr std::size_t block_size = 100;
constexpr std::size_t shots_per_block = 32;
constexpr std::size_t shot_size = 3;
constexpr std::size_t azimuth_at = 2;
constexpr std::size_t shots_at = 4;
constexpr std::size_t stamp_at = 1200;
constexpr std::size_t return_mode_at = 1204;
constexpr std::size_t product_at = 1205;

constexpr std::array<std::uint16_t, 4> bank_marks{0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};
constexpr std::size_t blocks_per_alpha_prime_firing = 4;
constexpr std::uint8_t strongest_return = 0x37;
constexpr std::uint8_t last_return = 0x38;
constexpr std::uint8_t dual_return = 0x39;
constexpr std::uint8_t product_vlp_32_ab = 0x23;
constexpr std::uint8_t product_velarray = 0x31;

constexpr std::int64_t hour_us = 3'600'000'000;
constexpr std::int64_t ns_per_us = 1000;
constexpr double astray_us = 86.4e9;  // a day: such times have nothing in common with the host's
constexpr std::int64_t latest_host_ns = 4'000'000'000'000'000'000;  // leaves room for the hour
constexpr double deg_per_step = 0.01;
constexpr int steps_per_turn = 36'000;
constexpr double full_turn_deg = 360.0;
constexpr double rad_per_deg = std::numbers::pi / 180.0;
constexpr double shortest_group_us = 2.6;
constexpr double longest_group_us = 2.95;
constexpr double longest_step_deg = 5.0;       // between columns; more are directions switched off
constexpr double slowest_deg_per_us = 0.0006;  // 100 turns a minute
constexpr double fastest_deg_per_us = 0.009;   // 1500 turns a minute

std::string in_hex(std::uint8_t byte) {
  constexpr const char* digits = "0123456789ABCDEF";
  return std::string("0x") + digits[byte >> 4] + digits[byte & 15];
}

std::size_t block_start(std::size_t block) {
  return block * block_size;
}

int azimuth_steps(const PacketBytes& packet, std::size_t block) {
  return packet.u16(block_start(block) + azimuth_at);
}

double turn_deg(int from_steps, int to_steps) {
  return ((to_steps - from_steps + steps_per_turn) % steps_per_turn) * deg_per_step;
}

// The HDL-64E has upper and lower banks in turns, and its status where others have the product.
bool looks_like_hdl_64e(const PacketBytes& packet) {
  return packet.u16(block_start(1)) == bank_marks[1] && packet.u16(block_start(2)) == bank_marks[0];
}

/// How the blocks of a packet follow each other.
struct Arrangement {
  bool dual = false;
  std::size_t blocks = blocks_per_packet;  ///< in use
  std::size_t blocks_per_column = 1;       ///< one column is one firing of all lasers
  std::size_t columns() const { return blocks / blocks_per_column; }
  std::size_t returns() const { return dual ? 2 : 1; }
};

Arrangement arrange(const VelodyneModel& model, std::uint8_t return_mode) {
  Arrangement blocks;
  blocks.dual = return_mode == dual_return;
  const bool banks = model.pace == VelodynePace::eights;
  blocks.blocks_per_column = (banks ? blocks_per_alpha_prime_firing : 1) * blocks.returns();
  if (banks && blocks.dual) blocks.blocks = blocks.blocks_per_column;
  return blocks;
}

class VelodyneDecoder final : public PacketDecoder {
 public:
  void add(std::span<const std::byte> payload, std::int64_t host_ns) override;
  void finish() override { sweep_.finish(); }
  std::string sensor() const override { return model_ == nullptr ? "Velodyne" : model_->name; }

 private:
  bool recognize(const PacketBytes& packet);
  bool mode_is_known(std::uint8_t return_mode);
  bool is_whole(const PacketBytes& packet, const Arrangement& blocks) const;
  std::int64_t place_in_time(std::int64_t past_hour_us, std::int64_t host_ns);
  void measure_pace(std::int64_t packet_us, const Arrangement& blocks);
  void measure_rate(const PacketBytes& packet, const Arrangement& blocks, std::int64_t packet_us);
  void begin_column(const PacketBytes& packet,
                    std::size_t block,
                    const Arrangement& blocks,
                    std::int64_t host_ns);
  void decode_block(const PacketBytes& packet, std::size_t block, const Arrangement& blocks);
  void emit(const PacketBytes& packet, std::size_t block, std::size_t shot, std::size_t laser);

  const VelodyneModel* model_ = nullptr;
  SweepBuilder sweep_{sweeps_};
  double group_us_ = alpha_prime_group_us;
  double deg_per_us_ = 0.0;
  struct Before {
    std::int64_t host_ns = 0;
    std::int64_t packet_us = 0;
    int azimuth_steps = 0;
  };
  std::optional<Before> before_;
  // Of the block at hand:
  std::int64_t packet_ns_ = 0;
  std::size_t time_block_ = 0;
  double column_us_ = 0.0;
};

void VelodyneDecoder::add(std::span<const std::byte> payload, std::int64_t received_ns) {
  const std::int64_t host_ns = std::clamp(received_ns, -latest_host_ns, latest_host_ns);
  const PacketBytes packet(payload);
  if (packet.size() != packet_size || packet.u16(0) != bank_marks[0] || !recognize(packet)) {
    ++counts_.foreign;
    return;
  }
  const std::int64_t past_hour_us = packet.u32(stamp_at);
  const std::uint8_t return_mode = packet.u8(return_mode_at);
  const Arrangement blocks = arrange(*model_, return_mode);
  if (!mode_is_known(return_mode) || past_hour_us >= hour_us || !is_whole(packet, blocks)) {
    ++counts_.damaged;
    return;
  }
  const std::int64_t packet_us = place_in_time(past_hour_us, host_ns);
  measure_pace(packet_us, blocks);
  measure_rate(packet, blocks, packet_us);
  before_ = Before{host_ns, packet_us, azimuth_steps(packet, 0)};
  packet_ns_ = packet_us * ns_per_us;
  for (std::size_t block = 0; block < blocks.blocks; ++block) {
    time_block_ = block / blocks.returns();
    if (block % blocks.blocks_per_column == 0) begin_column(packet, block, blocks, host_ns);
    decode_block(packet, block, blocks);
  }
  ++counts_.decoded;
}

// Where a sensor is set to a part of the turn, its packets hold columns of both ends of that part,
// and only the first has the packet's time: the others come as much later as the turn takes.
void VelodyneDecoder::begin_column(const PacketBytes& packet,
                                   std::size_t block,
                                   const Arrangement& blocks,
                                   std::int64_t host_ns) {
  column_us_ = velodyne_shot_us(model_->pace, time_block_, 0, group_us_);
  if (block > 0 && deg_per_us_ > 0.0) {
    const double step = turn_deg(azimuth_steps(packet, block - blocks.blocks_per_column),
                                 azimuth_steps(packet, block));
    if (step > longest_step_deg && step < full_turn_deg - longest_step_deg) {
      packet_ns_ += std::llround(step / deg_per_us_ * ns_per_us);
    }
  }
  sweep_.begin_column(azimuth_steps(packet, block) * deg_per_step,
                      packet_ns_ + std::llround(column_us_ * ns_per_us),
                      host_ns);
}

// Learns the model from the first packet; later ones have to be of the same.
bool VelodyneDecoder::recognize(const PacketBytes& packet) {
  const std::uint8_t product = packet.u8(product_at);
  if (model_ != nullptr) return product == model_->product;
  const auto refuse = [](const std::string& what) {
    throw Refusal(refusal_reason::wrong_kind, what);
  };
  if (looks_like_hdl_64e(packet)) {
    refuse("packets of a Velodyne HDL-64E, whose units each have a calibration of their own");
  }
  if (product == product_vlp_32_ab) {
    refuse("packets of a Velodyne VLP-32A or VLP-32B: they do not tell which, and angles differ");
  }
  if (product == product_velarray) refuse("packets of a Velodyne Velarray are not supported");
  const VelodyneModel* model = find_velodyne_model(product);
  if (model == nullptr) refuse("packets of a Velodyne with the unknown product " + in_hex(product));
  if (const std::uint8_t mode = packet.u8(return_mode_at);
      mode != strongest_return && mode != last_return && mode != dual_return) {
    refuse(std::string(model->name) + " in the unsupported return mode " + in_hex(mode));
  }
  model_ = model;
  return true;
}

bool VelodyneDecoder::mode_is_known(std::uint8_t return_mode) {
  return return_mode == strongest_return || return_mode == last_return ||
         return_mode == dual_return;
}

bool VelodyneDecoder::is_whole(const PacketBytes& packet, const Arrangement& blocks) const {
  for (std::size_t block = 0; block < blocks.blocks; ++block) {
    const bool banks = model_->pace == VelodynePace::eights;
    const std::size_t bank =
        banks ? block / blocks.returns() % blocks_per_alpha_prime_firing : std::size_t{0};
    if (packet.u16(block_start(block)) != bank_marks[bank]) return false;
    if (azimuth_steps(packet, block) > steps_per_turn) return false;
  }
  return true;
}

// Microseconds since 1970 of a time past the hour, nearest to what is expected.
std::int64_t VelodyneDecoder::place_in_time(std::int64_t past_hour_us, std::int64_t host_ns) {
  const double host_us = static_cast<double>(host_ns) / ns_per_us;
  double expected_us = host_us;
  if (before_ && std::abs(host_us - static_cast<double>(before_->packet_us)) < astray_us) {
    expected_us =
        static_cast<double>(before_->packet_us) +
        (static_cast<double>(host_ns) - static_cast<double>(before_->host_ns)) / ns_per_us;
  }
  return std::llround((expected_us - static_cast<double>(past_hour_us)) / hour_us) * hour_us +
         past_hour_us;
}

// Firmwares of the Alpha Prime differ in pace, which the time from packet to packet tells.
void VelodyneDecoder::measure_pace(std::int64_t packet_us, const Arrangement& blocks) {
  if (!before_ || model_->pace != VelodynePace::eights) return;
  const double firings = static_cast<double>(blocks.columns());
  const double group_us =
      static_cast<double>(packet_us - before_->packet_us) / (firings * velodyne_groups_per_firing);
  if (group_us > shortest_group_us && group_us < longest_group_us) group_us_ = group_us;
}

void VelodyneDecoder::measure_rate(const PacketBytes& packet,
                                   const Arrangement& blocks,
                                   std::int64_t packet_us) {
  double turned_deg = 0.0;
  double passed_us = 0.0;
  if (const std::size_t columns = blocks.columns(); columns > 1) {
    const std::size_t last = (columns - 1) * blocks.blocks_per_column;
    turned_deg = turn_deg(azimuth_steps(packet, 0), azimuth_steps(packet, last));
    passed_us = velodyne_shot_us(model_->pace, last / blocks.returns(), 0, group_us_) -
                velodyne_shot_us(model_->pace, 0, 0, group_us_);
  } else if (before_) {
    turned_deg = turn_deg(before_->azimuth_steps, azimuth_steps(packet, 0));
    passed_us = static_cast<double>(packet_us - before_->packet_us);
  }
  if (passed_us <= 0.0) return;
  // A step across directions that are switched off tells nothing about the rate.
  const double rate = turned_deg / passed_us;
  if (rate > slowest_deg_per_us && rate < fastest_deg_per_us) deg_per_us_ = rate;
}

void VelodyneDecoder::decode_block(const PacketBytes& packet,
                                   std::size_t block,
                                   const Arrangement& blocks) {
  const std::size_t bank = model_->pace == VelodynePace::eights
                               ? time_block_ % blocks_per_alpha_prime_firing
                               : std::size_t{0};
  for (std::size_t shot = 0; shot < shots_per_block; ++shot) {
    const std::size_t at = block_start(block) + shots_at + shot * shot_size;
    const std::uint16_t distance = packet.u16(at);
    if (distance == 0) continue;
    if (blocks.dual && block % 2 == 1 && packet.u16(at - block_size) == distance) continue;
    emit(packet, at, shot, (bank * shots_per_block + shot) % model_->lasers.size());
  }
}

void VelodyneDecoder::emit(const PacketBytes& packet,
                           std::size_t at,
                           std::size_t shot,
                           std::size_t laser) {
  const std::size_t block = at / block_size;
  const double shot_us = velodyne_shot_us(model_->pace, time_block_, shot, group_us_);
  const double azimuth = (azimuth_steps(packet, block) * deg_per_step +
                          deg_per_us_ * (shot_us - column_us_) - model_->lasers[laser].turned_deg) *
                         rad_per_deg;
  const double elevation = model_->lasers[laser].elevation_deg * rad_per_deg;
  const double range = packet.u16(at) * model_->unit_m;
  const double level = range * std::cos(elevation);
  const Eigen::Vector3d point(
      level * std::cos(azimuth), -level * std::sin(azimuth), range * std::sin(elevation));
  sweep_.add(point.cast<float>(),
             static_cast<float>(packet.u8(at + 2)),
             packet_ns_ + std::llround(shot_us * ns_per_us));
}

}  // namespace

std::unique_ptr<PacketDecoder> make_velodyne_decoder() {
  return std::make_unique<VelodyneDecoder>();
}

}  // namespace kissmap
