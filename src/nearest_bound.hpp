// SPDX-License-Identifier: MIT
#pragma once

namespace kissmap {

/// How near all but the nearest neighbour of a query are at least [m], once it has moved by `moved`
/// from where a search found the second nearest at `next_distance`; less what floats round off.
inline float others_beyond(float next_distance, float moved) {
  return next_distance - moved * 1.0001F - 1e-5F;
}

}  // namespace kissmap
