// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/sensors/packet_bytes.hpp"
#include "formats/sensors/velodyne_tables.hpp"

namespace kissmap {

inline constexpr std::size_t velodyne_shots_per_block = 32;
inline constexpr std::size_t velodyne_block_size = 100;
inline constexpr int velodyne_steps_per_turn = 36'000;  ///< of azimuths: 0.01 degrees

/// How the blocks of a packet follow each other.
struct VelodyneBlocks {
  bool dual = false;           ///< blocks come in pairs: last return, strongest return
  std::size_t count = 12;      ///< in use
  std::size_t per_column = 1;  ///< one column is one firing of all lasers, or two
  std::size_t banks = 1;       ///< of 32 lasers, one after the other
  std::size_t columns() const { return count / per_column; }
  std::size_t returns() const { return dual ? 2 : 1; }
  /// The bank of lasers a block is of.
  std::size_t bank(std::size_t block) const { return block / returns() % banks; }
};

/// Whether a payload has the size and the mark of Velodyne's data packets. Only then ask the rest.
bool is_velodyne_packet(const PacketBytes& bytes);

/// Whether it is an HDL-64E's, which has upper and lower banks in turns, and its status where
/// others have the product; azimuths are checked as well.
bool is_hdl_64e_packet(const PacketBytes& bytes);

/// The model a packet is of. Throws Refusal for one that is not supported or in a return mode that
/// is not, naming it.
const VelodyneModel& recognize_velodyne(const PacketBytes& bytes);

std::uint8_t velodyne_product(const PacketBytes& bytes);
VelodyneBlocks velodyne_blocks(const PacketBytes& bytes, const VelodyneModel& model);

/// Whether return mode, time, marks and azimuths are such as a sensor writes.
bool is_whole_velodyne_packet(const PacketBytes& bytes, const VelodyneBlocks& blocks);

std::int64_t velodyne_us_past_hour(const PacketBytes& bytes);
int velodyne_azimuth_steps(const PacketBytes& bytes, std::size_t block);

/// Where a shot stands: u16 distance, u8 intensity.
std::size_t velodyne_shot_at(std::size_t block, std::size_t shot);

}  // namespace kissmap
