// SPDX-License-Identifier: MIT
// Times and geometry of shots: the maker's user manuals, the ROS driver (velodyne_pointcloud) and
// velodyne_decoder, which agree but for constant delays.
#include "formats/sensors/velodyne_decoder.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "formats/sensors/packet_bytes.hpp"
#include "formats/sensors/past_hour_clock.hpp"
#include "formats/sensors/sweep_builder.hpp"
#include "formats/sensors/velodyne_packet.hpp"
#include "formats/sensors/velodyne_tables.hpp"

namespace kissmap {
namespace {

constexpr std::int64_t ns_per_us = 1000;
constexpr double deg_per_step = 0.01;
constexpr double full_turn_deg = 360.0;
constexpr double rad_per_deg = std::numbers::pi / 180.0;
constexpr double shortest_group_us = 2.6;
constexpr double longest_group_us = 2.95;
constexpr double longest_step_deg = 5.0;       // between columns; more are directions switched off
constexpr double slowest_deg_per_us = 0.0006;  // 100 turns a minute
constexpr double fastest_deg_per_us = 0.009;   // 1500 turns a minute

double turn_deg(int from_steps, int to_steps) {
  return ((to_steps - from_steps + velodyne_steps_per_turn) % velodyne_steps_per_turn) *
         deg_per_step;
}

class VelodyneDecoder final : public PacketDecoder {
 public:
  void add(std::span<const std::byte> payload, std::int64_t host_ns) override;
  void finish() override { sweep_.finish(); }
  std::string sensor() const override { return model_ == nullptr ? "Velodyne" : model_->name; }

 private:
  void pass_incomplete(std::size_t sweeps) override { sweep_.pass(sweeps); }
  void measure_pace(std::int64_t packet_us, const VelodyneBlocks& blocks);
  void measure_rate(const PacketBytes& packet,
                    const VelodyneBlocks& blocks,
                    std::int64_t packet_us);
  /// A column of a packet and what was known when it came, as it may be decoded later.
  struct Column {
    VelodyneBlocks blocks;
    std::size_t first_block = 0;
    std::int64_t packet_ns = 0;  ///< that of the packet, or what it would be without a gap before
    double begin_us = 0.0;       ///< after it
    double group_us = 0.0;
    double deg_per_us = 0.0;
    std::size_t time_block(std::size_t block) const { return block / blocks.returns(); }
  };
  Column begin_column(const PacketBytes& packet,
                      std::size_t block,
                      const VelodyneBlocks& blocks,
                      std::int64_t host_ns);
  void decode_column(const PacketBytes& packet, const Column& column);
  void decode_block(const PacketBytes& packet, std::size_t block, const Column& column);
  struct Shot {
    double azimuth, elevation;  ///< rad; the azimuth clockwise from above
    std::int64_t time_ns;
    Eigen::Vector3f at(double range) const;
  };
  Shot aim(const PacketBytes& packet,
           std::size_t block,
           std::size_t shot,
           std::size_t laser,
           const Column& column) const;

  const VelodyneModel* model_ = nullptr;
  SweepBuilder sweep_{sweeps_};
  double group_us_ = alpha_prime_group_us;
  double deg_per_us_ = 0.0;
  PastHourClock clock_;
  struct Before {
    std::int64_t packet_us = 0;
    int azimuth_steps = 0;
  };
  std::optional<Before> before_;
  std::int64_t packet_ns_ = 0;  ///< of the column at hand
};

void VelodyneDecoder::add(std::span<const std::byte> payload, std::int64_t received_ns) {
  const std::int64_t host_ns = placeable(received_ns);
  const PacketBytes packet(payload);
  if (!is_velodyne_packet(packet)) {
    ++counts_.foreign;
    return;
  }
  // Learnt from the first packet; later ones have to be of the same model.
  if (model_ == nullptr) model_ = &recognize_velodyne(packet);
  if (velodyne_product(packet) != model_->product) {
    ++counts_.foreign;
    return;
  }
  const VelodyneBlocks blocks = velodyne_blocks(packet, *model_);
  if (!is_whole_velodyne_packet(packet, blocks)) {
    ++counts_.damaged;
    return;
  }
  const std::int64_t packet_us = clock_.place(velodyne_us_past_hour(packet), host_ns);
  measure_pace(packet_us, blocks);
  measure_rate(packet, blocks, packet_us);
  before_ = Before{packet_us, velodyne_azimuth_steps(packet, 0)};
  packet_ns_ = packet_us * ns_per_us;
  KeptPacket kept(packet);
  for (std::size_t block = 0; block < blocks.count; block += blocks.per_column) {
    const Column column = begin_column(packet, block, blocks, host_ns);
    sweep_.decode_column(
        kept, [this, column](const PacketBytes& bytes) { decode_column(bytes, column); });
  }
  ++counts_.decoded;
}

// Where a sensor is set to a part of the turn, its packets hold columns of both ends of that part,
// and only the first has the packet's time: the others come as much later as the turn takes.
VelodyneDecoder::Column VelodyneDecoder::begin_column(const PacketBytes& packet,
                                                      std::size_t block,
                                                      const VelodyneBlocks& blocks,
                                                      std::int64_t host_ns) {
  if (block > 0 && deg_per_us_ > 0.0) {
    const double step = turn_deg(velodyne_azimuth_steps(packet, block - blocks.per_column),
                                 velodyne_azimuth_steps(packet, block));
    if (step > longest_step_deg && step < full_turn_deg - longest_step_deg) {
      packet_ns_ += std::llround(step / deg_per_us_ * ns_per_us);
    }
  }
  Column column{blocks, block, packet_ns_, 0.0, group_us_, deg_per_us_};
  column.begin_us = velodyne_shot_us(model_->pace, column.time_block(block), 0, group_us_);
  sweep_.begin_column(velodyne_azimuth_steps(packet, block) * deg_per_step,
                      packet_ns_ + std::llround(column.begin_us * ns_per_us),
                      host_ns,
                      blocks.per_column * velodyne_shots_per_block);
  return column;
}

// Firmwares of the Alpha Prime differ in pace, which the time from packet to packet tells.
void VelodyneDecoder::measure_pace(std::int64_t packet_us, const VelodyneBlocks& blocks) {
  if (!before_ || model_->pace != VelodynePace::eights) return;
  const double firings = static_cast<double>(blocks.columns());
  const double group_us =
      static_cast<double>(packet_us - before_->packet_us) / (firings * velodyne_groups_per_firing);
  if (group_us > shortest_group_us && group_us < longest_group_us) group_us_ = group_us;
}

void VelodyneDecoder::measure_rate(const PacketBytes& packet,
                                   const VelodyneBlocks& blocks,
                                   std::int64_t packet_us) {
  double turned_deg = 0.0;
  double passed_us = 0.0;
  if (const std::size_t columns = blocks.columns(); columns > 1) {
    const std::size_t last = (columns - 1) * blocks.per_column;
    turned_deg = turn_deg(velodyne_azimuth_steps(packet, 0), velodyne_azimuth_steps(packet, last));
    passed_us = velodyne_shot_us(model_->pace, last / blocks.returns(), 0, group_us_) -
                velodyne_shot_us(model_->pace, 0, 0, group_us_);
  } else if (before_) {
    turned_deg = turn_deg(before_->azimuth_steps, velodyne_azimuth_steps(packet, 0));
    passed_us = static_cast<double>(packet_us - before_->packet_us);
  }
  if (passed_us <= 0.0) return;
  // A step across directions that are switched off tells nothing about the rate.
  const double rate = turned_deg / passed_us;
  if (rate > slowest_deg_per_us && rate < fastest_deg_per_us) deg_per_us_ = rate;
}

void VelodyneDecoder::decode_column(const PacketBytes& packet, const Column& column) {
  for (std::size_t i = 0; i < column.blocks.per_column; ++i) {
    decode_block(packet, column.first_block + i, column);
  }
}

void VelodyneDecoder::decode_block(const PacketBytes& packet,
                                   std::size_t block,
                                   const Column& column) {
  const VelodyneBlocks& blocks = column.blocks;
  const std::size_t first_laser = blocks.bank(block) * velodyne_shots_per_block;
  for (std::size_t shot = 0; shot < velodyne_shots_per_block; ++shot) {
    const std::size_t at = velodyne_shot_at(block, shot);
    const std::uint16_t distance = packet.u16(at);
    const bool second = blocks.dual && block % 2 == 1;
    // The other return of the same shot.
    const bool twice = blocks.dual && packet.u16(velodyne_shot_at(second ? block - 1 : block + 1,
                                                                  shot)) == distance;
    if (second && twice) continue;
    if (distance == 0 && blocks.dual && !twice) continue;
    const std::size_t laser = (first_laser + shot) % model_->lasers.size();
    const Shot aimed = aim(packet, block, shot, laser, column);
    if (distance == 0) {
      sweep_.add_no_return(aimed.at(1.0), aimed.time_ns);
    } else {
      sweep_.add(aimed.at(distance * model_->unit_m),
                 static_cast<float>(packet.u8(at + 2)),
                 aimed.time_ns);
    }
  }
}

VelodyneDecoder::Shot VelodyneDecoder::aim(const PacketBytes& packet,
                                           std::size_t block,
                                           std::size_t shot,
                                           std::size_t laser,
                                           const Column& column) const {
  const double shot_us =
      velodyne_shot_us(model_->pace, column.time_block(block), shot, column.group_us);
  const double azimuth =
      (velodyne_azimuth_steps(packet, block) * deg_per_step +
       column.deg_per_us * (shot_us - column.begin_us) - model_->lasers[laser].turned_deg) *
      rad_per_deg;
  const double elevation = model_->lasers[laser].elevation_deg * rad_per_deg;
  return {azimuth, elevation, column.packet_ns + std::llround(shot_us * ns_per_us)};
}

Eigen::Vector3f VelodyneDecoder::Shot::at(double range) const {
  const double level = range * std::cos(elevation);
  const Eigen::Vector3d point(
      level * std::cos(azimuth), -level * std::sin(azimuth), range * std::sin(elevation));
  return point.cast<float>();
}

}  // namespace

std::unique_ptr<PacketDecoder> make_velodyne_decoder() {
  return std::make_unique<VelodyneDecoder>();
}

}  // namespace kissmap
