// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "support/occupancy_plan.hpp"

namespace kissmap {

/// Writes FOLDER/map.yaml and FOLDER/map.pgm as map servers want them: 0 occupied, 254 free, 205
/// unknown, the largest y in the first row. Returns the path of the YAML.
inline std::filesystem::path write_plan(const OccupancyPlan& plan,
                                        const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream pgm(folder / "map.pgm", std::ios::binary);
  pgm << "P5\n" << plan.width << ' ' << plan.height << "\n255\n";
  for (int row = plan.height - 1; row >= 0; --row) {
    for (int column = 0; column < plan.width; ++column) {
      const PlanCell cell = plan.cells[plan.index(column, row)];
      pgm.put(static_cast<char>(cell == PlanCell::occupied ? 0
                                : cell == PlanCell::free   ? 254
                                                           : 205));
    }
  }
  std::ofstream yaml(folder / "map.yaml");
  yaml.precision(17);
  yaml << "image: map.pgm\nresolution: " << plan.resolution << "\norigin: [" << plan.origin.x()
       << ", " << plan.origin.y() << ", 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
       << "free_thresh: 0.196\n";
  return folder / "map.yaml";
}

}  // namespace kissmap
