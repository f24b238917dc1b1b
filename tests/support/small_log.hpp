// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/gallery.hpp"

namespace kissmap {

/// Writes points as a binary PCD, x y z intensity.
inline void write_pcd(const std::filesystem::path& path,
                      const std::vector<Eigen::Vector3f>& points) {
  std::ofstream out(path, std::ios::binary);
  const std::string n = std::to_string(points.size());
  out << "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH "
      << n << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << n << "\nDATA binary\n";
  for (const Eigen::Vector3f& p : points) {
    const float row[4] = {p.x(), p.y(), p.z(), 7.0F};
    out.write(reinterpret_cast<const char*>(row), sizeof(row));
  }
}

/// "1700000000_400000000.pcd": the name of scan i at 10 Hz.
inline std::string scan_name(int i) {
  char name[64];
  std::snprintf(name, sizeof(name), "%d_%09d.pcd", 1'700'000'000 + i / 10, i % 10 * 100'000'000);
  return name;
}

/// A log of the first `scans` scans of the gallery.
inline void write_small_log(const std::filesystem::path& folder, int scans) {
  std::filesystem::create_directories(folder);
  const Gallery gallery;
  for (int i = 0; i < scans; ++i) write_pcd(folder / scan_name(i), gallery.scan(i).points);
}

}  // namespace kissmap
