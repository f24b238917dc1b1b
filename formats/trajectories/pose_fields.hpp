// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// The fields of a line of a trajectory. Everything here throws std::invalid_argument that says
/// what is wrong and what to do.
using Fields = std::vector<std::string_view>;

Fields split_at_spaces(std::string_view line);
Fields split_at_commas(std::string_view line);

double number(std::string_view field);
Eigen::Vector3d position(std::span<const std::string_view> fields);
/// Of about unit length, brought to it.
Eigen::Quaterniond unit_quaternion(const Eigen::Quaterniond& q);
/// The first twelve fields as [R | t], row by row.
Rigid3 pose_of_rows(std::span<const std::string_view> fields);

void require_columns(const Fields& fields, std::size_t least, std::size_t most);

}  // namespace kissmap
