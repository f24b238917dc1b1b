// SPDX-License-Identifier: MIT
#include "formats/trajectories/pose_lines.hpp"

#include <cstdio>

#include "formats/files/table.hpp"

namespace kissmap {

std::string seconds_text(std::int64_t stamp_ns) {
  constexpr std::uint64_t ns_per_s = 1'000'000'000;
  // Unsigned, because the smallest int64 has no positive counterpart.
  const auto bits = static_cast<std::uint64_t>(stamp_ns);
  const std::uint64_t magnitude = stamp_ns < 0 ? 0 - bits : bits;
  char text[32];
  std::snprintf(text,
                sizeof text,
                "%s%llu.%09llu",
                stamp_ns < 0 ? "-" : "",
                static_cast<unsigned long long>(magnitude / ns_per_s),
                static_cast<unsigned long long>(magnitude % ns_per_s));
  return text;
}

std::string tum_line(std::int64_t stamp_ns, const Rigid3& pose) {
  Rigid3 upright = pose;
  if (upright.rotation.w() < 0.0) upright.rotation.coeffs() *= -1.0;
  std::string line = seconds_text(stamp_ns) + ' ';
  append_pose(line, upright, ' ');
  return line + '\n';
}

std::string kitti_line(const Rigid3& pose) {
  const Eigen::Matrix4d matrix = pose.matrix();
  std::string line;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      if (!line.empty()) line += ' ';
      append_number(line, matrix(row, column));
    }
  }
  return line + '\n';
}

}  // namespace kissmap
