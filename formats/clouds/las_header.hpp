// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "kissmap/formats/cloud_writer.hpp"

namespace kissmap {

inline constexpr double las_scale = 0.001;  ///< m, step of a coordinate

/// What the header of a LAS file says about the points, once they are known.
struct LasContent {
  std::uint64_t points = 0;
  Eigen::Array3i low = Eigen::Array3i::Zero();  ///< steps from the offset
  Eigen::Array3i high = Eigen::Array3i::Zero();
};

/// Bytes of a point record: that of format 0, 1, 2 or 3, then the fields LAS has no place for as
/// extra bytes (LAS 1.4, table 24), in the order normal, scan, sensor.
std::uint16_t las_record_size(const CloudFields& fields);

/// Public header and variable length records; as long for any content. LAS 1.2, or 1.4 if more
/// points may come than 32 bits can count.
std::string las_header(const CloudWriterOptions& options, const LasContent& content);

}  // namespace kissmap
