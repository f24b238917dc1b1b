// SPDX-License-Identifier: MIT
#include "formats/sensors/past_hour_clock.hpp"

#include <algorithm>
#include <cmath>

namespace kissmap {
namespace {

constexpr std::int64_t hour_us = 3'600'000'000;
constexpr double ns_per_us = 1000.0;
constexpr double astray_us = 86.4e9;  // a day: such times have nothing in common with the host's
constexpr std::int64_t latest_host_ns = 4'000'000'000'000'000'000;

}  // namespace

std::int64_t PastHourClock::place(std::int64_t past_hour_us, std::int64_t host_ns) {
  const double host_us = static_cast<double>(host_ns) / ns_per_us;
  double expected_us = host_us;
  if (before_ && std::abs(host_us - static_cast<double>(before_->packet_us)) < astray_us) {
    expected_us =
        static_cast<double>(before_->packet_us) +
        (static_cast<double>(host_ns) - static_cast<double>(before_->host_ns)) / ns_per_us;
  }
  const auto hours = std::llround((expected_us - static_cast<double>(past_hour_us)) / hour_us);
  const std::int64_t packet_us = hours * hour_us + past_hour_us;
  before_ = Before{host_ns, packet_us};
  return packet_us;
}

std::int64_t placeable(std::int64_t host_ns) {
  return std::clamp(host_ns, -latest_host_ns, latest_host_ns);
}

}  // namespace kissmap
