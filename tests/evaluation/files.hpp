// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "formats/trajectories/pose_lines.hpp"
#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

inline std::filesystem::path write_text(const std::filesystem::path& path,
                                        const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

/// Ten poses a second from 1,700,000,000 s on.
inline std::string tum_text(const std::vector<Rigid3>& poses) {
  std::string text = tum_header;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto stamp = 1'700'000'000'000'000'000 + static_cast<std::int64_t>(i) * 100'000'000;
    text += tum_line(stamp, poses[i]);
  }
  return text;
}

inline std::string kitti_text(const std::vector<Rigid3>& poses) {
  std::string text;
  for (const Rigid3& pose : poses) text += kitti_line(pose);
  return text;
}

}  // namespace kissmap
