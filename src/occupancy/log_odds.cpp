// SPDX-License-Identifier: MIT
#include "kissmap/occupancy/log_odds.hpp"

#include "options.hpp"

namespace kissmap {

void require_valid(const OccupancyOptions& options) {
  require_between("hit", options.hit, 0.51, 0.98);
  require_between("miss", options.miss, 0.02, 0.49);
  require_between("lowest", options.lowest, 0.02, 0.49);
  require_between("highest", options.highest, 0.51, 0.98);
  require_between("free_margin", options.free_margin, 0.0, 10.0);
}

}  // namespace kissmap
