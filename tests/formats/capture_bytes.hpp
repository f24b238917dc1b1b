// SPDX-License-Identifier: MIT
// Writes packet captures byte by byte.
#pragma once

#include <string>
#include <vector>

#include "formats/support.hpp"

namespace kissmap::test {

inline std::string big16(std::size_t value) {
  return Bytes(std::endian::big).add<std::uint16_t>(static_cast<std::uint16_t>(value)).text();
}

inline std::string udp(std::uint16_t port, const std::string& payload) {
  return big16(5000) + big16(port) + big16(payload.size() + 8) + big16(0) + payload;
}

inline std::string ipv4(const std::string& content,
                        std::uint16_t id = 1,
                        std::size_t place = 0,
                        char protocol = 17) {
  return std::string("\x45\x00", 2) + big16(content.size() + 20) + big16(id) + big16(place) +
         "\x40" + protocol + big16(0) + "\x0a\x01\x01\x01\x0a\x01\x01\x02" + content;
}

inline std::string ethernet(const std::string& packet) {
  return std::string(12, 'm') + "\x08" + std::string(1, '\0') + packet;
}

inline std::string pcap_head(std::uint32_t link, std::endian order, std::uint32_t magic) {
  return Bytes(order)
      .add<std::uint32_t>(magic)
      .add<std::uint16_t>(2)
      .add<std::uint16_t>(4)
      .add<std::uint32_t>(0)
      .add<std::uint32_t>(0)
      .add<std::uint32_t>(262144)
      .add<std::uint32_t>(link)
      .text();
}

inline std::string pcap_record(const std::string& frame,
                               std::uint32_t fraction = 5,
                               std::endian order = std::endian::little,
                               std::size_t original = 0) {
  return Bytes(order)
             .add<std::uint32_t>(1700000000)
             .add<std::uint32_t>(fraction)
             .add<std::uint32_t>(static_cast<std::uint32_t>(frame.size()))
             .add<std::uint32_t>(static_cast<std::uint32_t>(std::max(original, frame.size())))
             .text() +
         frame;
}

inline std::string pcap(const std::vector<std::string>& frames, std::uint32_t link = 1) {
  std::string file = pcap_head(link, std::endian::little, 0xA1B2C3D4);
  for (const std::string& frame : frames) file += pcap_record(frame);
  return file;
}

inline std::string pcapng_block(std::uint32_t type,
                                std::string body,
                                std::endian order = std::endian::little) {
  body.resize((body.size() + 3) / 4 * 4, '\0');
  const auto size = static_cast<std::uint32_t>(body.size() + 12);
  return Bytes(order).add<std::uint32_t>(type).add<std::uint32_t>(size).text() + body +
         Bytes(order).add<std::uint32_t>(size).text();
}

/// A section of one Ethernet interface whose times are in ns.
inline std::string pcapng_head(std::endian order = std::endian::little) {
  const std::string section =
      Bytes(order).add<std::uint32_t>(0x1A2B3C4D).add<std::uint32_t>(1).text();
  const std::string interface =
      Bytes(order).add<std::uint16_t>(1).add<std::uint16_t>(0).add<std::uint32_t>(0).text();
  const std::string resolution = Bytes(order).add<std::uint16_t>(9).add<std::uint16_t>(1).text() +
                                 std::string("\x09\x00\x00\x00", 4);
  return pcapng_block(0x0A0D0D0A, section + std::string(8, '\xff'), order) +
         pcapng_block(1, interface + resolution, order);
}

inline std::string pcapng_packet(const std::string& frame,
                                 std::uint64_t ns,
                                 std::endian order = std::endian::little) {
  const auto size = static_cast<std::uint32_t>(frame.size());
  const std::string head = Bytes(order)
                               .add<std::uint32_t>(0)
                               .add<std::uint32_t>(static_cast<std::uint32_t>(ns >> 32U))
                               .add<std::uint32_t>(static_cast<std::uint32_t>(ns))
                               .add<std::uint32_t>(size)
                               .add<std::uint32_t>(size)
                               .text();
  return pcapng_block(6, head + frame, order);
}

}  // namespace kissmap::test
