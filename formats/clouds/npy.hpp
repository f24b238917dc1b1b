// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

/// Reads a NumPy array of points: shape (N, k >= 3) of any real numbers, whose columns are x y z
/// intensity and others, or shape (N) of records with named fields. C or Fortran order, either byte
/// order. The records point into `file`. Throws Refusal.
/// Specification: NumPy enhancement proposal 1, "A Simple File Format for NumPy Arrays".
PointRecords read_npy(std::span<const std::byte> file);

}  // namespace kissmap
