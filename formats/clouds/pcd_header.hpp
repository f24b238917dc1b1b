// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

enum class PcdEncoding { ascii, binary, binary_compressed };

struct PcdHeader {
  std::vector<RecordField> fields;  ///< offsets and strides of packed records
  std::size_t stride = 0;           ///< bytes of a point
  std::size_t points = 0;
  PcdEncoding encoding = PcdEncoding::ascii;
  std::size_t size = 0;   ///< bytes of the header
  std::size_t lines = 0;  ///< lines of the header
};

/// Throws Refusal naming the line.
PcdHeader read_pcd_header(std::span<const std::byte> file);

}  // namespace kissmap
