// SPDX-License-Identifier: MIT
#include "formats/clouds/time_rule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kissmap {
namespace {

/// Farther apart than this, the stamp and the points cannot come from one clock. [s]
constexpr double max_clock_difference = 1.0;

struct Extent {
  double first = std::numeric_limits<double>::infinity();
  double last = -std::numeric_limits<double>::infinity();
  double span() const { return last - first; }
};

Extent extent_of(const RawTimes& times) {
  Extent extent;
  for (const double value : times.values) {
    if (!std::isfinite(value)) continue;
    extent.first = std::min(extent.first, value);
    extent.last = std::max(extent.last, value);
  }
  return extent;
}

double median_magnitude(const RawTimes& times) {
  std::vector<double> magnitudes;
  magnitudes.reserve(times.values.size());
  for (const double value : times.values) {
    if (std::isfinite(value)) {
      magnitudes.push_back(std::abs(static_cast<double>(times.base) + value));
    }
  }
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return *middle;
}

std::int64_t nanoseconds_in(TimeUnit unit) {
  constexpr std::int64_t table[] = {1'000'000'000, 1'000'000, 1'000, 1};
  return table[static_cast<std::size_t>(unit)];
}

// A sweep lasts 0.02 to 2 s, so only one unit makes sense of its span.
TimeUnit unit_from_span(double span) {
  if (span <= 2.0) return TimeUnit::seconds;
  if (span <= 2e3) return TimeUnit::milliseconds;
  if (span <= 2e6) return TimeUnit::microseconds;
  return TimeUnit::nanoseconds;
}

std::optional<TimeUnit> unit_named(const std::string& name) {
  constexpr const char* names[] = {"s", "ms", "us", "ns"};
  const auto* found = std::ranges::find(names, name);
  if (found == std::end(names)) return std::nullopt;
  return static_cast<TimeUnit>(found - names);
}

TimeReading reading_of_integers(const RawTimes& times, double span, double magnitude) {
  if (size_of(times.type) == 4) return {TimeUnit::nanoseconds, false};
  // The span tells microseconds since 1970 from nanoseconds since a sensor's start.
  return {unit_from_span(span), magnitude > 1e15};
}

TimeReading reading_of_floats(double span, double magnitude) {
  if (magnitude > 1e17) return {TimeUnit::nanoseconds, true};
  if (magnitude > 1e14) return {TimeUnit::microseconds, true};
  if (magnitude > 1e11) return {TimeUnit::milliseconds, true};
  // Seconds since 1970 and nanoseconds within a sweep are both around 1e8 and more.
  if (magnitude > 1e8 && span <= 2.0) return {TimeUnit::seconds, true};
  return {unit_from_span(span), false};
}

bool is_integer(ScalarType type) {
  return type != ScalarType::f32 && type != ScalarType::f64;
}

StampInstant instant_of_zero(double first, double last) {
  const double tolerance = 0.1 * (last - first);
  if (std::abs(first) <= tolerance) return StampInstant::sweep_start;
  if (std::abs(last) <= tolerance) return StampInstant::sweep_end;
  if (std::abs(first + last) <= 2.0 * tolerance) return StampInstant::sweep_middle;
  return StampInstant::unknown;
}

/// Offset [s] of a whole number of units from the stamp, subtracted in integers: a double holds an
/// absolute time only to 0.2 us. Nothing if the time does not fit into 64 bits.
std::optional<double> seconds_after_stamp(std::int64_t base,
                                          double whole,
                                          std::int64_t unit_ns,
                                          std::int64_t stamp_ns) {
  if (std::abs(whole) >= 9.2e18) return std::nullopt;
  std::int64_t value = 0;
  std::int64_t value_ns = 0;
  std::int64_t difference = 0;
  if (__builtin_add_overflow(base, static_cast<std::int64_t>(whole), &value) ||
      __builtin_mul_overflow(value, unit_ns, &value_ns) ||
      __builtin_sub_overflow(value_ns, stamp_ns, &difference)) {
    return std::nullopt;
  }
  return static_cast<double>(difference) * 1e-9;
}

}  // namespace

std::string describe(const TimeReading& reading) {
  constexpr const char* names[] = {"seconds", "milliseconds", "microseconds", "nanoseconds"};
  return std::string(reading.absolute ? "absolute " : "relative ") +
         names[static_cast<std::size_t>(reading.unit)];
}

std::optional<TimeReading> find_time_reading(const RawTimes& times,
                                             const std::string& unit_option) {
  const double span = extent_of(times).span();
  if (!(span > 0.0) || !std::isfinite(span) || size_of(times.type) < 4) return std::nullopt;
  const double magnitude = median_magnitude(times);
  if (const auto unit = unit_named(unit_option)) {
    const double seconds = magnitude * static_cast<double>(nanoseconds_in(*unit)) * 1e-9;
    return TimeReading{*unit, seconds > 1e8};
  }
  return is_integer(times.type) ? reading_of_integers(times, span, magnitude)
                                : reading_of_floats(span, magnitude);
}

std::optional<SweepTimes> times_from_stamp(const RawTimes& times,
                                           const TimeReading& reading,
                                           std::int64_t stamp_ns) {
  const Extent extent = extent_of(times);
  const std::int64_t unit_ns = nanoseconds_in(reading.unit);
  const double unit = static_cast<double>(unit_ns) * 1e-9;
  const double span = extent.span() * unit;
  if (!(span > 0.0 && span <= max_sweep_seconds)) return std::nullopt;

  const double whole = std::floor(extent.first);
  const std::optional<double> start =
      seconds_after_stamp(times.base, whole, unit_ns, reading.absolute ? stamp_ns : 0);
  const double first = start.value_or(1e9) + (extent.first - whole) * unit;
  // Relative times may begin before the stamp, but not by more than a sweep.
  const double tolerance = reading.absolute ? max_clock_difference : max_sweep_seconds;

  SweepTimes sweep;
  sweep.from_first_point = std::abs(first) > tolerance;
  const double origin = sweep.from_first_point ? extent.first : whole;
  const double shift = sweep.from_first_point ? 0.0 : *start;
  sweep.offsets.reserve(times.values.size());
  for (const double value : times.values) {
    sweep.offsets.push_back(static_cast<float>((value - origin) * unit + shift));
  }
  const double zero_to_first = (extent.first - origin) * unit + shift;
  sweep.stamp_instant = instant_of_zero(zero_to_first, zero_to_first + span);
  return sweep;
}

}  // namespace kissmap
