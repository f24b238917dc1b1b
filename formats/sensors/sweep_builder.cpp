// SPDX-License-Identifier: MIT
#include "formats/sensors/sweep_builder.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace kissmap {
namespace {

constexpr double full_turn_deg = 360.0;
constexpr double rounding_deg = 0.005;  // sensors tell azimuths in hundredths of a degree
constexpr double backwards_deg = 10.0;
constexpr std::int64_t longest_gap_ns = 300'000'000;
constexpr std::int64_t longest_sweep_ns = 1'000'000'000;
constexpr double most_turns_lost = 0.5;
constexpr double longest_column_s = 0.01;  // longer steps in time are interruptions: no measure
constexpr std::size_t most_shots = 4'000'000;
constexpr std::int64_t day_ns = 86'400'000'000'000;
constexpr double seconds_per_ns = 1e-9;

// Times come from the input: their difference may not fit.
bool apart_by_more_than(std::int64_t a, std::int64_t b, std::int64_t limit_ns) {
  return std::abs(static_cast<double>(a) - static_cast<double>(b)) > static_cast<double>(limit_ns);
}

double step_deg(double from, double to) {
  const double forwards =
      std::fmod(std::fmod(to - from, full_turn_deg) + full_turn_deg, full_turn_deg);
  return forwards > full_turn_deg - backwards_deg ? forwards - full_turn_deg : forwards;
}

std::vector<float> seconds_after(std::int64_t first_ns, std::span<const std::int64_t> times_ns) {
  std::vector<float> seconds;
  seconds.reserve(times_ns.size());
  for (const std::int64_t time_ns : times_ns) {
    const auto passed_ns = static_cast<double>(time_ns - first_ns);
    seconds.push_back(static_cast<float>(passed_ns * seconds_per_ns));
  }
  return seconds;
}

}  // namespace

void SweepBuilder::begin_column(double azimuth_deg,
                                std::int64_t time_ns,
                                std::int64_t host_ns,
                                std::size_t shots) {
  end_column();
  place_column(azimuth_deg, time_ns, host_ns);
  shots_ += shots;
}

// Ends the sweep before it where it has to end.
void SweepBuilder::place_column(double azimuth_deg, std::int64_t time_ns, std::int64_t host_ns) {
  if (!begun_) {
    restart(azimuth_deg, time_ns, host_ns);
    return;
  }
  if (apart_by_more_than(time_ns, last_time_ns_, longest_gap_ns)) {
    finish();
    restart(azimuth_deg, time_ns, host_ns);
    return;
  }
  const double step = step_deg(last_azimuth_deg_, azimuth_deg);
  if (turn_was_lost(step, static_cast<double>(time_ns - last_time_ns_) * seconds_per_ns)) {
    finish();
    restart(azimuth_deg, time_ns, host_ns);
    return;
  }
  covered_deg_ += step;
  last_azimuth_deg_ = azimuth_deg;
  last_time_ns_ = time_ns;
  if (std::abs(covered_deg_) > full_turn_deg - rounding_deg) {
    finish();
    covered_deg_ = std::remainder(covered_deg_, full_turn_deg);
    begin_sweep(time_ns, host_ns);
  } else if (apart_by_more_than(time_ns, sweep_time_ns_, longest_sweep_ns) || shots_ > most_shots) {
    finish();
    restart(azimuth_deg, time_ns, host_ns);
  }
}

// Whether a step took longer than the azimuths passed account for: turns that go unseen.
bool SweepBuilder::turn_was_lost(double step, double passed_s) {
  if (passed_s > longest_column_s && deg_per_s_ > 0.0) {
    const double unseen_deg = passed_s * deg_per_s_ - std::abs(step);
    return unseen_deg > most_turns_lost * full_turn_deg;
  }
  if (passed_s > 0.0 && step != 0.0) deg_per_s_ = std::abs(step) / passed_s;
  return false;
}

void SweepBuilder::restart(double azimuth_deg, std::int64_t time_ns, std::int64_t host_ns) {
  covered_deg_ = 0.0;
  last_azimuth_deg_ = azimuth_deg;
  last_time_ns_ = time_ns;
  begin_sweep(time_ns, host_ns);
}

void SweepBuilder::begin_sweep(std::int64_t time_ns, std::int64_t host_ns) {
  begun_ = true;
  sweep_time_ns_ = time_ns;
  sweep_host_ns_ = host_ns;
}

void SweepBuilder::add(const Eigen::Vector3f& point, float intensity, std::int64_t time_ns) {
  // Units and corrections come with the packets and their calibration: any number may.
  if (!point.allFinite() || point.isZero(0.0F) || point.norm() > max_plausible_range) {
    ++(point.allFinite() ? scan_.dropped.implausible : scan_.dropped.non_finite);
    return;
  }
  scan_.points.push_back(point);
  scan_.intensities.push_back(intensity);
  times_ns_.push_back(time_ns);
}

void SweepBuilder::add_no_return(const Eigen::Vector3f& direction, std::int64_t time_ns) {
  if (!direction.allFinite()) return;  // as angles of a calibration may be
  scan_.no_return_directions.push_back(direction);
  no_return_times_ns_.push_back(time_ns);
}

void SweepBuilder::pass(std::size_t sweeps) {
  to_pass_ = sweeps;
  if (to_pass_ > 0) return;
  for (const auto& decode : std::exchange(put_off_, {})) {
    end_column();
    decode();
  }
}

void SweepBuilder::end_column() {
  if (scan_.points.size() == column_points_) {
    scan_.no_return_directions.resize(column_no_returns_);
    no_return_times_ns_.resize(column_no_returns_);
  }
  column_points_ = scan_.points.size();
  column_no_returns_ = scan_.no_return_directions.size();
}

void SweepBuilder::finish() {
  end_column();
  begun_ = false;
  column_points_ = 0;
  column_no_returns_ = 0;
  shots_ = 0;
  put_off_.clear();
  Scan scan = std::exchange(scan_, {});
  const std::vector<std::int64_t> times_ns = std::exchange(times_ns_, {});
  const std::vector<std::int64_t> no_return_times_ns = std::exchange(no_return_times_ns_, {});
  if (times_ns.empty()) return;
  const std::int64_t first_ns = *std::min_element(times_ns.begin(), times_ns.end());
  scan.time_offsets = seconds_after(first_ns, times_ns);
  scan.no_return_time_offsets = seconds_after(first_ns, no_return_times_ns);
  const bool clock_unset = apart_by_more_than(first_ns, sweep_host_ns_, day_ns);
  scan.stamp_ns = clock_unset ? sweep_host_ns_ : first_ns;
  scan.stamp_instant = StampInstant::sweep_start;
  scan.compensation = Compensation::no;
  scan.time_source = TimeSource::recorded;
  sweeps_.push_back(std::move(scan));
  if (to_pass_ > 0) --to_pass_;
}

}  // namespace kissmap
