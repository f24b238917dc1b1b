// SPDX-License-Identifier: MIT
// From packets of a Velodyne to the scans that are made of them.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "formats/sensor_recording.hpp"
#include "formats/sensors/velodyne_decoder.hpp"
#include "formats/velodyne_packets.hpp"

namespace kissmap::test {

inline constexpr unsigned vlp_16 = 0x22;
inline constexpr unsigned puck_hi_res = 0x24;
inline constexpr unsigned hdl_32e = 0x21;
inline constexpr unsigned vlp_32c = 0x28;
inline constexpr unsigned vls_128 = 0xA1;
inline constexpr unsigned strongest = 0x37;
inline constexpr unsigned last = 0x38;
inline constexpr unsigned dual = 0x39;
inline constexpr std::int64_t second_ns = 1'000'000'000;
inline constexpr std::int64_t host_ns = 1'700'000'000 * second_ns;
inline constexpr std::uint32_t host_us_past_hour = 800'000'000;  // 1700000000 = 472222 h + 800 s

/// Of packets that are all read, and all received at `host_ns`.
inline std::vector<Scan> decode_velodyne(const std::vector<VelodynePacket>& packets) {
  const auto decoder = make_velodyne_decoder();
  for (const VelodynePacket& packet : packets) decoder->add(packet.bytes(), host_ns);
  decoder->finish();
  EXPECT_EQ(decoder->counts().decoded, packets.size());
  return take_all(*decoder);
}

}  // namespace kissmap::test
