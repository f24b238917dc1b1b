// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

/// Whether a file begins like a PLY.
bool looks_like_ply(std::span<const std::byte> first_bytes);

/// Reads the vertices of a PLY 1.0 file: ascii or binary of either byte order, any properties in
/// any order. Other elements and lists are passed over. The records may point into `file`; memory
/// is bounded by a small multiple of the file's size. Throws Refusal naming the line or byte.
/// Specification: Greg Turk, The PLY Polygon File Format, 1994.
PointRecords read_ply(std::span<const std::byte> file);

}  // namespace kissmap
