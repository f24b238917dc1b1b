// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// First line of a TUM trajectory file.
inline constexpr const char* tum_header = "# timestamp tx ty tz qx qy qz qw\n";

/// Seconds with 9 decimals, exact for every stamp.
std::string seconds_text(std::int64_t stamp_ns);

/// "stamp tx ty tz qx qy qz qw\n", w >= 0, every number such that it reads back exactly.
/// Both throw Error(internal) for a pose that is not rigid.
std::string tum_line(std::int64_t stamp_ns, const Rigid3& pose);

/// Rows of [R | t], 12 numbers. Without stamps.
std::string kitti_line(const Rigid3& pose);

}  // namespace kissmap
