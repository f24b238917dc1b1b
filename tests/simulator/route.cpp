// SPDX-License-Identifier: MIT
#include "simulator/route.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kissmap::simulator {
namespace {

using Points = std::vector<Eigen::Vector3d>;
constexpr double step = 0.1;  // m between the samples of a route

// The route at one sample.
struct Station {
  Eigen::Vector3d position;
  double along = 0.0;      // m
  double yaw = 0.0;        // rad, unwrapped
  double pitch = 0.0;      // rad
  double curvature = 0.0;  // 1/m, positive to the left
  double speed = 0.0;      // m/s
  double time = 0.0;       // s
};

double wrap(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

// Replaces the inner corners of a polyline by arcs, given as chords.
Points round_corners(const Points& way_points, double radius) {
  Points rounded{way_points.front()};
  for (std::size_t i = 1; i + 1 < way_points.size(); ++i) {
    const Eigen::Vector3d& corner = way_points[i];
    const Eigen::Vector3d before = way_points[i - 1] - corner;
    const Eigen::Vector3d after = way_points[i + 1] - corner;
    const double half_turn =
        0.5 * (std::numbers::pi -
               std::acos(std::clamp(before.normalized().dot(after.normalized()), -1.0, 1.0)));
    const double cut =
        std::min({radius * std::tan(half_turn), 0.5 * before.norm(), 0.5 * after.norm()});
    if (cut < step || half_turn < 1e-3) {
      rounded.push_back(corner);
      continue;
    }
    // The arc touches both legs at `cut` from the corner; its centre lies on the bisector.
    const Eigen::Vector3d bisector = (before.normalized() + after.normalized()).normalized();
    const double arc_radius = cut / std::tan(half_turn);
    const Eigen::Vector3d centre = corner + arc_radius / std::cos(half_turn) * bisector;
    const Eigen::Vector3d along = (after.normalized() - before.normalized()).normalized();
    const int chords = std::max(2, static_cast<int>(std::ceil(2 * half_turn * arc_radius / step)));
    for (int k = 0; k <= chords; ++k) {
      const double angle = half_turn * (2.0 * k / chords - 1.0);
      rounded.push_back(centre +
                        arc_radius * (std::sin(angle) * along - std::cos(angle) * bisector));
    }
  }
  rounded.push_back(way_points.back());
  return rounded;
}

Points resample(const Points& polyline) {
  Points samples{polyline.front()};
  double missing = step;
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    const Eigen::Vector3d leg = polyline[i] - polyline[i - 1];
    const double length = leg.norm();
    double at = missing;
    for (; at <= length; at += step) samples.push_back(polyline[i - 1] + at / length * leg);
    missing = at - length;
  }
  return samples;
}

// Moving average over `window` metres, shorter towards the ends so that they stay in place.
Points smooth(const Points& samples, double window) {
  const auto n = static_cast<std::ptrdiff_t>(samples.size());
  const auto reach = static_cast<std::ptrdiff_t>(std::round(0.5 * window / step));
  Points smoothed;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const std::ptrdiff_t near = std::min({reach, i, n - 1 - i});
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::ptrdiff_t k = i - near; k <= i + near; ++k)
      sum += samples[static_cast<std::size_t>(k)];
    smoothed.emplace_back(sum / static_cast<double>(2 * near + 1));
  }
  return smoothed;
}

std::vector<Station> survey(const Points& samples) {
  std::vector<Station> stations(samples.size());
  const std::size_t last = samples.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    Station& here = stations[i];
    here.position = samples[i];
    const Eigen::Vector3d tangent = samples[std::min(i + 1, last)] - samples[i == 0 ? 0 : i - 1];
    here.yaw = std::atan2(tangent.y(), tangent.x());
    here.pitch = -std::atan2(tangent.z(), tangent.head<2>().norm());
    if (i == 0) continue;
    const Station& back = stations[i - 1];
    const double length = (here.position - back.position).norm();
    here.along = back.along + length;
    here.yaw = back.yaw + wrap(here.yaw - back.yaw);
    here.curvature = (here.yaw - back.yaw) / std::max(length, 1e-6);
  }
  return stations;
}

// The fastest allowed speeds: corners first, then no sharper accelerating or braking than allowed.
void plan_speed(std::vector<Station>& stations, const DrivingStyle& style) {
  for (Station& s : stations) {
    const double in_corner =
        std::sqrt(style.lateral_acceleration / std::max(std::abs(s.curvature), 1e-6));
    const double turning = style.turn_rate / std::max(std::abs(s.curvature), 1e-6);
    s.speed = std::min({style.max_speed, in_corner, turning});
  }
  stations.front().speed = stations.back().speed = 0.0;
  const auto limit = [](Station& to, const Station& from, double acceleration) {
    const double length = std::abs(to.along - from.along);
    to.speed = std::min(to.speed, std::sqrt(from.speed * from.speed + 2 * acceleration * length));
  };
  for (std::size_t i = 1; i < stations.size(); ++i) {
    limit(stations[i], stations[i - 1], style.acceleration);
  }
  for (std::size_t i = stations.size() - 1; i > 0; --i) {
    limit(stations[i - 1], stations[i], style.braking);
  }
  for (std::size_t i = 1; i < stations.size(); ++i) {
    const double mean = 0.5 * (stations[i].speed + stations[i - 1].speed);
    const double length = stations[i].along - stations[i - 1].along;
    stations[i].time = stations[i - 1].time + length / std::max(mean, 1e-3);
  }
}

PoseVector pose_between(const Station& a,
                        const Station& b,
                        double time,
                        const DrivingStyle& style) {
  // Constant acceleration from one station to the next.
  const double duration = std::max(b.time - a.time, 1e-9);
  const double since = std::clamp(time - a.time, 0.0, duration);
  const double forward = (b.speed - a.speed) / duration;
  const double speed = a.speed + forward * since;
  const double part = 0.5 * (a.speed + speed) * since / std::max(b.along - a.along, 1e-9);
  const auto mix = [part](double from, double to) { return from + part * (to - from); };
  PoseVector pose;
  pose.head<3>() = a.position + part * (b.position - a.position);
  pose[3] = style.roll_by_acceleration * speed * speed * mix(a.curvature, b.curvature);
  pose[4] = mix(a.pitch, b.pitch) - style.pitch_by_acceleration * forward;
  pose[5] = mix(a.yaw, b.yaw);
  return pose;
}

std::vector<PoseVector> sample_in_time(const std::vector<Station>& stations,
                                       const DrivingStyle& style) {
  std::vector<PoseVector> poses;
  const auto count = static_cast<std::size_t>(std::ceil(stations.back().time / style.interval)) + 1;
  std::size_t next = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double time = static_cast<double>(i) * style.interval;
    while (next + 1 < stations.size() && stations[next].time < time) ++next;
    poses.push_back(pose_between(stations[next - 1], stations[next], time, style));
  }
  return poses;
}

// Turns in place from one yaw to another with a bell-shaped rate.
void append_turn(std::vector<PoseVector>& poses, double angle, const DrivingStyle& style) {
  const PoseVector start = poses.back();
  // The fifth-order minimum-jerk blend peaks at 15/8 of its mean rate.
  const double duration = 1.875 * std::abs(angle) / style.turn_rate;
  const int count = static_cast<int>(std::ceil(duration / style.interval));
  for (int i = 1; i <= count; ++i) {
    const double u = static_cast<double>(i) / count;
    PoseVector pose = start;
    pose[5] += angle * u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
    poses.push_back(pose);
  }
}

}  // namespace

std::vector<PoseVector> drive(const Points& way_points, const DrivingStyle& style) {
  const Points rounded = round_corners(way_points, style.corner_radius);
  std::vector<Station> stations = survey(smooth(resample(rounded), style.corner_smoothing));
  plan_speed(stations, style);
  return sample_in_time(stations, style);
}

std::vector<PoseVector> drive_with_turns_in_place(const Points& way_points,
                                                  const DrivingStyle& style) {
  std::vector<PoseVector> poses;
  for (std::size_t i = 1; i < way_points.size(); ++i) {
    std::vector<PoseVector> leg = drive({way_points[i - 1], way_points[i]}, style);
    if (!poses.empty()) {
      const double angle = wrap(leg.front()[5] - poses.back()[5]);
      if (std::abs(angle) > 1e-6) append_turn(poses, angle, style);
      const double whole_turns = poses.back()[5] - leg.front()[5];
      for (PoseVector& pose : leg) pose[5] += whole_turns;
    }
    poses.insert(poses.end(), leg.begin(), leg.end());
  }
  return poses;
}

}  // namespace kissmap::simulator
