// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace kissmap {

inline constexpr std::size_t glyph_height = 5;

/// A character drawn in dots; '#' is ink.
struct Glyph {
  char character;
  std::array<std::string_view, glyph_height> rows;  ///< equally long
};

/// A small letter without a shape of its own takes that of the capital, anything else unknown is
/// blank.
const Glyph& find_glyph(char character);

}  // namespace kissmap
