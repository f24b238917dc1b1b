// SPDX-License-Identifier: MIT
#include "formats/conversion/scan_rows.hpp"

#include <bit>
#include <cstring>

namespace kissmap {

static_assert(std::endian::native == std::endian::little);

std::string ScanRows::bytes(const Scan& scan) const {
  std::string rows(scan.points.size() * columns() * sizeof(float), '\0');
  char* to = rows.data();
  const auto put = [&to](float value) {
    std::memcpy(to, &value, sizeof(value));
    to += sizeof(value);
  };
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    for (const float coordinate : scan.points[i]) put(coordinate);
    if (with_intensity) put(scan.intensities.empty() ? 0.0F : scan.intensities[i]);
    if (with_time) put(scan.time_offsets.empty() ? 0.0F : scan.time_offsets[i]);
  }
  return rows;
}

}  // namespace kissmap
