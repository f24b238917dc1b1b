// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "formats/sensors/hesai_tables.hpp"
#include "formats/sensors/packet_bytes.hpp"

namespace kissmap {

/// Where things stand in a data packet of a model, and what its tail says.
struct HesaiPacket {
  std::size_t first_block_at = 0;
  std::size_t block_size = 0;
  std::size_t azimuth_at = 0;   ///< in the block: u16 [0.01 deg], then the shots
  std::size_t shot_size = 0;    ///< u16 distance, u8 reflectivity, and what follows
  double unit_m = 0.0;          ///< of distances
  std::size_t returns = 1;      ///< blocks of one column
  std::size_t first_order = 0;  ///< of the model's two orders of firing: that of the first column
  double turns_per_minute = 0.0;
  std::int64_t time_ns = 0;  ///< ns since 1970 by the sensor's clock

  std::size_t block_start(std::size_t block) const { return first_block_at + block * block_size; }
};

/// The model a payload is of; null for other traffic. Throws Refusal for a Hesai that is not
/// supported, naming it.
const HesaiModel* recognize_hesai(const PacketBytes& bytes);

/// The packet of a model that was recognized; none if it is damaged. Throws Refusal for a mode that
/// is not supported.
std::optional<HesaiPacket> read_hesai_packet(const PacketBytes& bytes, const HesaiModel& model);

}  // namespace kissmap
