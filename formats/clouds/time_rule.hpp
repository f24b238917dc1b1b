// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/clouds/record_layout.hpp"
#include "kissmap/cloud/scan.hpp"

namespace kissmap {

/// Names under which drivers and datasets store the time of a point, in order of preference.
inline constexpr const char* time_field_names[] = {
    "t", "time", "timestamp", "time_stamp", "offset_time", "time_offset_ns", "ts", "stamp"};

/// Times of the points as recorded. Value i is base + values[i]; 64-bit integers keep their
/// digits that way. A value may be NaN.
struct RawTimes {
  ScalarType type = ScalarType::f32;
  std::int64_t base = 0;
  std::vector<double> values;
};

enum class TimeUnit : std::uint8_t { seconds, milliseconds, microseconds, nanoseconds };

/// How a log writes the time of a point.
struct TimeReading {
  TimeUnit unit = TimeUnit::seconds;
  bool absolute = false;  ///< since an epoch, not since some instant of the sweep
  friend bool operator==(const TimeReading&, const TimeReading&) = default;
};
std::string describe(const TimeReading& reading);

/// Finds unit and zero from type, span and size of the numbers. `unit_option` is "", or "s", "ms",
/// "us", "ns" where the user knows better. Nothing when all times are equal, none is finite, or
/// the type is too narrow for a time.
std::optional<TimeReading> find_time_reading(const RawTimes& times, const std::string& unit_option);

/// Times relative to a stamp.
struct SweepTimes {
  std::vector<float> offsets;  ///< s; NaN where the recorded time is not finite
  StampInstant stamp_instant = StampInstant::unknown;  ///< the instant at which offsets are zero
  bool from_first_point = false;  ///< clocks differ: the earliest point was put at the stamp
};

/// Nothing when the times span 0 or more than max_sweep_seconds: they then tell nothing of motion
/// within a sweep.
std::optional<SweepTimes> times_from_stamp(const RawTimes& times,
                                           const TimeReading& reading,
                                           std::int64_t stamp_ns);
inline constexpr double max_sweep_seconds = 2.0;

}  // namespace kissmap
