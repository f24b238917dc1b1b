// SPDX-License-Identifier: MIT
#include "formats/products/grid_size.hpp"

#include <algorithm>
#include <cstdio>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr double coarsest = 10.0;  // m

// Counts of columns beside cells, or the cells of two parts beside those of both; pictures.
constexpr double bytes_while_made = 28.0;
constexpr double bytes_of_cell = 8.0;

std::string describe(const Eigen::AlignedBox2d& area) {
  char text[160];
  std::snprintf(text,
                sizeof(text),
                "x %.1f to %.1f, y %.1f to %.1f m",
                area.min().x(),
                area.max().x(),
                area.min().y(),
                area.max().y());
  return text;
}

Error too_large(const Eigen::AlignedBox2d& area,
                double resolution,
                double bytes,
                const GridExportOptions& options) {
  char text[300];
  std::snprintf(text,
                sizeof(text),
                "a map of %.0f x %.0f m in cells of %g m takes %.3g GB, and --max-memory is %.3g; "
                "take a coarser --resolution, a %s--crop, or more memory",
                area.sizes().x(),
                area.sizes().y(),
                resolution,
                1e-9 * bytes,
                1e-9 * static_cast<double>(options.max_memory),
                options.crop ? "smaller " : "");
  return usage_error(text);
}

}  // namespace

Eigen::AlignedBox2d worked_area(const Eigen::AlignedBox2d& seen, const GridExportOptions& options) {
  if (!options.crop || seen.isEmpty()) return seen;
  if (seen.intersection(*options.crop).isEmpty()) {
    throw usage_error("crop: nothing was seen in it; what was seen is " + describe(seen));
  }
  // Way and groups go on beyond the crop: what is connected and what is small is known beyond.
  return options.connected ? seen : seen.intersection(*options.crop);
}

double cell_bytes(const Eigen::AlignedBox2d& area, double resolution, std::uint32_t levels) {
  if (area.isEmpty()) return 0.0;
  const Eigen::Array2d cells = area.sizes().array() / resolution + 16.0;  // whole blocks
  return cells.prod() * (bytes_while_made + bytes_of_cell * (levels - 1.0));
}

double resolution_in_memory(double fitting,
                            const Eigen::AlignedBox2d& seen,
                            std::uint32_t levels,
                            const GridExportOptions& options) {
  Eigen::AlignedBox2d area = worked_area(seen, options);
  if (options.crop) area.extend(*options.crop);
  const auto bytes = [&](double resolution) { return cell_bytes(area, resolution, levels); };
  const auto most = static_cast<double>(options.max_memory);
  double resolution = options.resolution == 0.0 ? fitting : options.resolution;
  while (options.resolution == 0.0 && bytes(resolution) > most && resolution < coarsest) {
    resolution = std::min(2.0 * resolution, coarsest);
  }
  if (bytes(resolution) > most) throw too_large(area, resolution, bytes(resolution), options);
  return resolution;
}

}  // namespace kissmap
