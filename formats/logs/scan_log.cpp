// SPDX-License-Identifier: MIT
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

void ScanLog::skip(std::size_t count) {
  while (count-- > 0 && next()) {
  }
}

}  // namespace kissmap
