// SPDX-License-Identifier: MIT
// Layout of packets: the maker's user manuals, the ROS driver (velodyne_pointcloud) and
// velodyne_decoder, which agree.
#include "formats/sensors/velodyne_packet.hpp"

#include <array>
#include <string>

#include "formats/clouds/refusal.hpp"
#include "formats/sensors/foreign_sensor.hpp"

namespace kissmap {
namespace {

constexpr std::size_t packet_size = 1206;
constexpr std::size_t azimuth_at = 2;
constexpr std::size_t shots_at = 4;
constexpr std::size_t shot_size = 3;
constexpr std::size_t stamp_at = 1200;
constexpr std::size_t return_mode_at = 1204;
constexpr std::size_t product_at = 1205;

constexpr std::array<std::uint16_t, 4> bank_marks{0xEEFF, 0xDDFF, 0xCCFF, 0xBBFF};
constexpr std::uint8_t strongest_return = 0x37;
constexpr std::uint8_t last_return = 0x38;
constexpr std::uint8_t dual_return = 0x39;
constexpr std::uint8_t product_vlp_32_ab = 0x23;
constexpr std::uint8_t product_velarray = 0x31;
constexpr std::int64_t hour_us = 3'600'000'000;

[[noreturn]] void refuse(const std::string& what) {
  throw Refusal(refusal_reason::wrong_kind, what);
}

std::string in_hex(std::uint8_t byte) {
  constexpr const char* digits = "0123456789ABCDEF";
  return std::string("0x") + digits[byte >> 4] + digits[byte & 15];
}

std::uint16_t mark(const PacketBytes& bytes, std::size_t block) {
  return bytes.u16(block * velodyne_block_size);
}

bool looks_like_hdl_64e(const PacketBytes& bytes) {
  return mark(bytes, 1) == bank_marks[1] && mark(bytes, 2) == bank_marks[0];
}

bool mode_is_known(std::uint8_t mode) {
  return mode == strongest_return || mode == last_return || mode == dual_return;
}

}  // namespace

bool is_velodyne_packet(const PacketBytes& bytes) {
  return bytes.size() == packet_size && mark(bytes, 0) == bank_marks[0];
}

bool is_hdl_64e_packet(const PacketBytes& bytes) {
  for (std::size_t block = 0; block < VelodyneBlocks().count; ++block) {
    if (mark(bytes, block) != bank_marks[block % 2]) return false;
    if (velodyne_azimuth_steps(bytes, block) > velodyne_steps_per_turn) return false;
  }
  return true;
}

const VelodyneModel& recognize_velodyne(const PacketBytes& bytes) {
  const std::uint8_t product = velodyne_product(bytes);
  if (looks_like_hdl_64e(bytes)) {
    refuse(
        "packets of a Velodyne HDL-64E, whose units each have a calibration of their own: give it "
        "with --calibration, the ROS driver's YAML file");
  }
  if (product == product_vlp_32_ab) {
    refuse("packets of a Velodyne VLP-32A or VLP-32B: they do not tell which, and angles differ; " +
           unread_velodyne_cure());
  }
  if (product == product_velarray) {
    refuse("packets of a Velodyne Velarray are not read; " + unread_velodyne_cure());
  }
  const VelodyneModel* model = find_velodyne_model(product);
  if (model == nullptr) {
    refuse("packets of a Velodyne with the unknown product " + in_hex(product) + "; " +
           unread_velodyne_cure());
  }
  if (const std::uint8_t mode = bytes.u8(return_mode_at); !mode_is_known(mode)) {
    refuse(std::string(model->name) + " in the unsupported return mode " + in_hex(mode));
  }
  return *model;
}

std::uint8_t velodyne_product(const PacketBytes& bytes) {
  return bytes.u8(product_at);
}

VelodyneBlocks velodyne_blocks(const PacketBytes& bytes, const VelodyneModel& model) {
  VelodyneBlocks blocks;
  blocks.dual = bytes.u8(return_mode_at) == dual_return;
  blocks.banks = (model.lasers.size() + velodyne_shots_per_block - 1) / velodyne_shots_per_block;
  blocks.per_column = blocks.banks * blocks.returns();
  blocks.count = blocks.count / blocks.per_column * blocks.per_column;
  return blocks;
}

bool is_whole_velodyne_packet(const PacketBytes& bytes, const VelodyneBlocks& blocks) {
  if (!mode_is_known(bytes.u8(return_mode_at)) || velodyne_us_past_hour(bytes) >= hour_us) {
    return false;
  }
  for (std::size_t block = 0; block < blocks.count; ++block) {
    if (mark(bytes, block) != bank_marks[blocks.bank(block)]) return false;
    if (velodyne_azimuth_steps(bytes, block) > velodyne_steps_per_turn) return false;
  }
  return true;
}

std::int64_t velodyne_us_past_hour(const PacketBytes& bytes) {
  return bytes.u32(stamp_at);
}

int velodyne_azimuth_steps(const PacketBytes& bytes, std::size_t block) {
  return bytes.u16(block * velodyne_block_size + azimuth_at);
}

std::size_t velodyne_shot_at(std::size_t block, std::size_t shot) {
  return block * velodyne_block_size + shots_at + shot * shot_size;
}

}  // namespace kissmap
