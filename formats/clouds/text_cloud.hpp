// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

/// Reads points as lines of text: x y z, then intensity, then anything; numbers between spaces,
/// tabs, commas or semicolons, whatever the locale. A first line of names says which column is
/// which. Blank lines and lines that begin with # or // are passed over. Throws Refusal naming the
/// line.
PointRecords read_text_cloud(std::span<const std::byte> file);

}  // namespace kissmap
