// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "kissmap/formats/pictures.hpp"

namespace kissmap {

/// What write_png() writes.
std::string png_bytes(const Picture& picture);

}  // namespace kissmap
