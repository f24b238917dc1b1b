// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kissmap {

/// The sensor, and what to do, if a datagram is a data packet of a maker kissmap does not read:
/// "packets of a RoboSense ..., which are not read; ...". Nothing for any other.
std::optional<std::string> describe_foreign_sensor(std::span<const std::byte> payload);

/// What a Hesai's packet says of its layout.
struct HesaiMark {
  unsigned major = 0;  ///< of the protocol
  unsigned minor = 0;
  unsigned lasers = 0;
  unsigned blocks = 0;  ///< in the packet
};

/// The same for packets of a Hesai that are not read.
std::string describe_unread_hesai(const HesaiMark& mark);

/// What to do with packets of a Velodyne that are not read.
std::string unread_velodyne_cure();

}  // namespace kissmap
