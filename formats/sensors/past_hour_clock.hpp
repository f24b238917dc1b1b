// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

namespace kissmap {

/// Places Velodyne's times, which count from the last full hour: the hour is that which is nearest
/// to the host's time at the first packet, and nearest to the time gone by since, later on. A host
/// clock that is set while recording moves nothing. Not thread safe.
class PastHourClock {
 public:
  /// Microseconds since 1970 of a packet that says `past_hour_us`, received at `host_ns`.
  std::int64_t place(std::int64_t past_hour_us, std::int64_t host_ns);

 private:
  struct Before {
    std::int64_t host_ns = 0;
    std::int64_t packet_us = 0;
  };
  std::optional<Before> before_;
};

/// Times of receiving beyond what leaves room for the hour are set to its ends.
std::int64_t placeable(std::int64_t host_ns);

}  // namespace kissmap
