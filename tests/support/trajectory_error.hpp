// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace kissmap {

/// Positions by stamp [ns].
using Positions = std::map<std::int64_t, Eigen::Vector3d>;

/// Reads a TUM file; the stamps keep all their digits.
inline Positions read_tum_positions(const std::filesystem::path& path) {
  Positions positions;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    std::string stamp;
    Eigen::Vector3d p;
    fields >> stamp >> p.x() >> p.y() >> p.z();
    const std::size_t dot = stamp.find('.');
    std::string fraction = dot == std::string::npos ? "" : stamp.substr(dot + 1);
    fraction.resize(9, '0');
    positions[std::stoll(stamp.substr(0, dot) + fraction)] = p;
  }
  return positions;
}

inline double length_of(const Positions& positions) {
  double length = 0.0;
  for (auto it = positions.begin(); it != positions.end() && std::next(it) != positions.end();
       ++it) {
    length += (std::next(it)->second - it->second).norm();
  }
  return length;
}

struct TrajectoryError {
  std::size_t matched = 0;
  double ate = 0.0;  ///< m, root mean square after SE(3) alignment
};

/// ATE (Sturm et al., IROS 2012) of estimate against truth; pairs within `tolerance_ns`.
inline TrajectoryError trajectory_error(const Positions& estimate,
                                        const Positions& truth,
                                        std::int64_t tolerance_ns = 20'000'000) {
  std::vector<Eigen::Vector3d> from;
  std::vector<Eigen::Vector3d> to;
  for (const auto& [stamp, position] : estimate) {
    auto after = truth.lower_bound(stamp);
    if (after != truth.begin() &&
        (after == truth.end() || after->first - stamp > stamp - std::prev(after)->first)) {
      --after;
    }
    if (after == truth.end() || std::abs(after->first - stamp) > tolerance_ns) continue;
    from.push_back(position);
    to.push_back(after->second);
  }
  TrajectoryError error;
  error.matched = from.size();
  if (from.size() < 3) return error;
  const auto columns = [](const std::vector<Eigen::Vector3d>& points) {
    return Eigen::Map<const Eigen::Matrix3Xd>(
        points[0].data(), 3, static_cast<Eigen::Index>(points.size()));
  };
  const Eigen::Matrix4d aligned = Eigen::umeyama(columns(from), columns(to), false);
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    sum += ((aligned.topLeftCorner<3, 3>() * from[i] + aligned.topRightCorner<3, 1>()) - to[i])
               .squaredNorm();
  }
  error.ate = std::sqrt(sum / static_cast<double>(from.size()));
  return error;
}

}  // namespace kissmap
