// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "formats/clouds/record_layout.hpp"
#include "kissmap/formats/cloud_writer.hpp"

namespace kissmap {

static_assert(std::endian::native == std::endian::little, "written without swapping bytes");

/// A column of a cloud file. Names follow what readers of the format look for.
struct PointColumn {
  const char* pcd_name;
  const char* ply_name;
  ScalarType type;
};

/// The columns of PCD and PLY files, in order; `colour` are those of the colour, which differ.
std::vector<PointColumn> point_columns(const CloudFields& fields,
                                       const std::vector<PointColumn>& colour);

template <class Value>
void append_value(Value value, std::string& bytes) {
  char raw[sizeof(Value)];
  std::memcpy(raw, &value, sizeof(Value));
  bytes.append(raw, sizeof(Value));
}
void append_vector(const Eigen::Vector3f& vector, std::string& bytes);

/// Appends the values of these columns but the colour, which comes last. Throws Error(internal) for
/// coordinates that are not finite.
void append_columns(const CloudPoint& point, const CloudWriterOptions& options, std::string& bytes);

/// "made by kissmap; frame map, metres, ..." for the header of a file.
std::string frame_comment(const CloudWriterOptions& options);

/// "1234567.125", as short as it reads back exactly.
std::string shortest_decimal(double value);

std::unique_ptr<CloudWriter> open_pcd_writer(const std::filesystem::path& path,
                                             const CloudWriterOptions& options);
std::unique_ptr<CloudWriter> open_ply_writer(const std::filesystem::path& path,
                                             const CloudWriterOptions& options);
std::unique_ptr<CloudWriter> open_las_writer(const std::filesystem::path& path,
                                             const CloudWriterOptions& options);

}  // namespace kissmap
