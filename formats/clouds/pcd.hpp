// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

/// Whether a file begins like a PCD. Looks at the first line that is no comment.
bool looks_like_pcd(std::span<const std::byte> first_bytes);

/// Reads a PCD v0.7 file (or its older kin): ascii, binary or binary_compressed, any fields in any
/// order. Bytes behind the points are ignored: PCL pads its files. The records may point into
/// `file`. Memory is bounded by the file's size, times 88 where compressed.
/// Throws Refusal naming the line or byte. Specification:
/// https://pointclouds.org/documentation/tutorials/pcd_file_format.html
PointRecords read_pcd(std::span<const std::byte> file);

}  // namespace kissmap
