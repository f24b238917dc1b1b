// SPDX-License-Identifier: MIT
#include "kissmap/formats/scan_log.hpp"

#include <algorithm>
#include <iterator>

#include "formats/clouds/bin.hpp"
#include "kissmap/error.hpp"

namespace kissmap {

void require_valid(const ReadOptions& options) {
  constexpr const char* units[] = {"", "s", "ms", "us", "ns", "none"};
  if (std::ranges::find(units, options.time_unit) == std::end(units)) {
    throw usage_error("time_unit: '" + options.time_unit + "' is none of s, ms, us, ns, none");
  }
  const int columns = options.bin_columns;
  if (columns != 0 && (columns < min_bin_columns || columns > max_bin_columns)) {
    throw usage_error("bin_columns: " + std::to_string(columns) + " is neither 0 (found by rule) " +
                      "nor in " + std::to_string(min_bin_columns) + ".." +
                      std::to_string(max_bin_columns));
  }
}

void ScanLog::skip(std::size_t count) {
  while (count-- > 0 && next()) {
  }
}

}  // namespace kissmap
