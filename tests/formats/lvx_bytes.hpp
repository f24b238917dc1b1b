// SPDX-License-Identifier: MIT
// Writes the parts of LVX files byte by byte.
#pragma once

#include <string>

#include "formats/support.hpp"

namespace kissmap::test {

/// Of version 1.`minor`, with one sensor.
inline std::string lvx_header(int minor, float yaw, float x, bool enabled = true) {
  std::string text = "livox_tech" + std::string(6, '\0');
  Bytes bytes;
  bytes.add<std::uint8_t>(1)
      .add<std::uint8_t>(static_cast<std::uint8_t>(minor))
      .add<std::uint16_t>(0);
  bytes.add<std::uint32_t>(0xAC0EA767);
  if (minor > 0) bytes.add<std::uint32_t>(50);
  bytes.add<std::uint8_t>(1);
  bytes.pad(32).add<std::uint8_t>(0).add<std::uint8_t>(7);
  if (minor > 0) bytes.add<std::uint8_t>(enabled ? 1 : 0);
  bytes.add<float>(0).add<float>(0).add<float>(yaw).add<float>(x).add<float>(0).add<float>(0);
  return text + bytes.text();
}

/// What stands before the shots of a packet of the first sensor.
inline Bytes lvx_packet_head(std::int64_t time_ns, std::uint8_t type) {
  Bytes bytes;
  bytes.add<std::uint8_t>(0).pad(4).add<std::uint32_t>(0).add<std::uint8_t>(0).add<std::uint8_t>(
      type);
  bytes.add<std::uint64_t>(static_cast<std::uint64_t>(time_ns));
  return bytes;
}

/// A frame at `offset` of the file.
inline std::string lvx_frame(
    int minor, std::size_t offset, std::uint64_t number, const std::string& body, bool last) {
  const std::size_t head = minor == 0 ? 32 : 24;
  Bytes frame;
  frame.add<std::uint64_t>(offset);
  frame.add<std::uint64_t>(last ? 0 : offset + head + body.size());
  frame.add<std::uint64_t>(number);
  if (minor == 0) frame.add<std::uint64_t>(3);
  return frame.text() + body;
}

}  // namespace kissmap::test
