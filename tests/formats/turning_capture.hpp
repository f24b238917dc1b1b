// SPDX-License-Identifier: MIT
// Captures of a sensor that turns: 10 sweeps a second of 28,800 returns each by 75 packets.
#pragma once

#include <string>

#include "formats/capture_bytes.hpp"
#include "formats/velodyne_packets.hpp"

namespace kissmap::test {

inline constexpr std::int64_t turn_start_s = 1'700'000'000;  // 800 s past an hour
inline constexpr std::int64_t turn_packet_us = 1'333;
inline constexpr int packets_per_turn = 75;

/// A record of a pcap with a datagram received so long after the start.
inline std::string datagram_record(std::int64_t us,
                                   std::uint16_t port,
                                   const std::string& payload) {
  const std::string frame = ethernet(ipv4(udp(port, payload)));
  return Bytes()
             .add<std::uint32_t>(static_cast<std::uint32_t>(turn_start_s + us / 1'000'000))
             .add<std::uint32_t>(static_cast<std::uint32_t>(us % 1'000'000))
             .add<std::uint32_t>(static_cast<std::uint32_t>(frame.size()))
             .add<std::uint32_t>(static_cast<std::uint32_t>(frame.size()))
             .text() +
         frame;
}

/// Packet `number` of a VLP-16 to port 2368.
inline std::string turning_record(int number) {
  constexpr unsigned vlp_16 = 0x22;
  constexpr unsigned strongest = 0x37;
  const std::int64_t us = number * turn_packet_us;
  VelodynePacket packet(vlp_16, strongest, static_cast<std::uint32_t>(800'000'000 + us));
  packet.all_shots(5'000);
  for (std::size_t block = 0; block < VelodynePacket::blocks; ++block) {
    packet.azimuth(block, (number * 12L + static_cast<long>(block)) * 40);
  }
  const std::vector<std::byte> bytes = packet.bytes();
  return datagram_record(
      us, 2368, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

inline std::string turning_capture(int packets) {
  std::string file = pcap_head(1, std::endian::little, 0xA1B2C3D4);
  for (int i = 0; i < packets; ++i) file += turning_record(i);
  return file;
}

/// A position packet as Velodyne's: 512 bytes, the sentence at 206.
inline std::string position_payload(const std::string& sentence) {
  std::string payload(512, '\0');
  payload.replace(206, sentence.size(), sentence);
  return payload;
}

}  // namespace kissmap::test
