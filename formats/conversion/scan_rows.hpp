// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "kissmap/cloud/scan.hpp"

namespace kissmap {

/// Points as rows of float32: x y z, then intensity and time where `with_...` says so.
struct ScanRows {
  bool with_intensity = false;
  bool with_time = false;

  std::size_t columns() const { return 3U + (with_intensity ? 1U : 0U) + (with_time ? 1U : 0U); }
  /// Little endian. Values a scan does not have are 0.
  std::string bytes(const Scan& scan) const;
};

}  // namespace kissmap
