// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>

#include "formats/sensors/hesai_decoder.hpp"

namespace kissmap {

/// Reads a unit's own file of angles, CSV with the columns channel (from 1), elevation and azimuth
/// [deg]; a byte order mark, lines before the header and more columns do not matter. `origin` names
/// it in errors. Throws Error(input) naming the line. Layout: HesaiLidar_SDK_2.0,
/// correction/angle_correction.
HesaiAngles read_hesai_angles(std::string_view csv, const std::filesystem::path& origin);

}  // namespace kissmap
