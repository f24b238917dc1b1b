// SPDX-License-Identifier: MIT
// Ground truth as data sets publish it. Layouts: file_player_mulran (issues 1 and 6: pose of the
// vehicle's base), pyboreas DATA_REFERENCE.md, nclt2ros, the loaders of KISS-ICP, PIN-SLAM and
// oxspires_tools; CT-ICP and mola_input_paris_luco_dataset.
#include "formats/trajectories/dataset_poses.hpp"

#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "formats/text/lines.hpp"
#include "formats/text/stamps.hpp"

namespace kissmap {
namespace {

constexpr std::size_t nclt_columns = 7;
constexpr std::size_t newer_college_columns = 9;
constexpr std::size_t spires_columns = 10;
constexpr std::size_t matrix_columns = 13;
constexpr std::size_t ns_digits = 19;
constexpr std::size_t us_digits = 16;

bool is_whole_number(std::string_view field) {
  return !field.empty() && field.find_first_not_of("0123456789") == std::string_view::npos;
}

std::int64_t whole_number(std::string_view field) {
  std::int64_t value = 0;
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (error == std::errc() && stop == end) return value;
  throw std::invalid_argument(in_quotes(field) + " is not a whole number");
}

std::int64_t microseconds(std::string_view field) {
  const std::int64_t us = whole_number(field);
  if (us > 0 && us < 9'000'000'000'000'000) return us * 1000;
  throw std::invalid_argument(in_quotes(field) + " is no stamp in microseconds");
}

std::int64_t seconds_and_nanoseconds(std::string_view s, std::string_view ns) {
  const std::int64_t seconds = whole_number(s);
  const std::int64_t rest = whole_number(ns);
  if (seconds >= 0 && seconds < 9'000'000'000 && rest >= 0 && rest < 1'000'000'000) {
    return seconds * 1'000'000'000 + rest;
  }
  throw std::invalid_argument("seconds and nanoseconds out of range");
}

Eigen::Quaterniond quaternion_xyzw(std::span<const std::string_view> f) {
  return unit_quaternion({number(f[3]), number(f[0]), number(f[1]), number(f[2])});
}

Eigen::Matrix3d about(const Eigen::Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

PoseRow mulran_row(const Fields& fields) {
  static const Rigid3 base_from_lidar = mulran_base_from_lidar();
  const Rigid3 world_from_base = pose_of_rows(std::span(fields).subspan(1));
  return {whole_number(fields[0]), world_from_base * base_from_lidar};
}

// Of the LiDAR already. Angles turn axes, not points.
PoseRow boreas_row(const Fields& fields) {
  const Eigen::Matrix3d rotation = about(Eigen::Vector3d::UnitX(), -number(fields[7])) *
                                   about(Eigen::Vector3d::UnitY(), -number(fields[8])) *
                                   about(Eigen::Vector3d::UnitZ(), -number(fields[9]));
  return {microseconds(fields[0]),
          {Eigen::Quaterniond(rotation), position(std::span(fields).subspan(1))}};
}

// From x forward, y right, z down to x forward, y left, z up, as the scans are turned.
PoseRow nclt_row(const Fields& fields) {
  const Eigen::Matrix3d rotation = about(Eigen::Vector3d::UnitZ(), number(fields[6])) *
                                   about(Eigen::Vector3d::UnitY(), number(fields[5])) *
                                   about(Eigen::Vector3d::UnitX(), number(fields[4]));
  const Eigen::Matrix3d turn = Eigen::Vector3d(1, -1, -1).asDiagonal();
  const Eigen::Matrix3d turned = turn * rotation * turn;
  return {microseconds(fields[0]),
          {Eigen::Quaterniond(turned), turn * position(std::span(fields).subspan(1))}};
}

PoseRow sec_nsec_row(const Fields& fields, std::size_t first) {
  const auto from = std::span(fields).subspan(first);
  return {seconds_and_nanoseconds(from[0], from[1]),
          {quaternion_xyzw(from.subspan(5)), position(from.subspan(2))}};
}

PoseRow apollo_row(const Fields& fields) {
  const auto stamp = nanoseconds_from_seconds(fields[1]);
  if (!stamp) throw std::invalid_argument(in_quotes(fields[1]) + " is no stamp in seconds");
  const auto from = std::span(fields).subspan(2);
  return {*stamp, {quaternion_xyzw(from.subspan(3)), position(from)}};
}

std::size_t columns_of(PoseLayout layout) {
  switch (layout) {
    case PoseLayout::nclt:
      return nclt_columns;
    case PoseLayout::newer_college:
    case PoseLayout::apollo:
      return newer_college_columns;
    case PoseLayout::spires:
      return spires_columns;
    default:
      return matrix_columns;
  }
}

}  // namespace

std::vector<std::int64_t> paris_luco_stamps(std::size_t rows) {
  std::vector<std::int64_t> stamps;
  for (std::size_t k = 0; k < rows; ++k) {
    stamps.push_back(static_cast<std::int64_t>(k) * paris_luco_period_ns +
                     paris_luco_period_ns / 2);
  }
  return stamps;
}

Rigid3 mulran_base_from_lidar() {
  constexpr double degree = std::numbers::pi / 180.0;
  const Eigen::Matrix3d rotation = about(Eigen::Vector3d::UnitZ(), 179.6654 * degree) *
                                   about(Eigen::Vector3d::UnitY(), 0.0003 * degree) *
                                   about(Eigen::Vector3d::UnitX(), 0.0001 * degree);
  return {Eigen::Quaterniond(rotation), Eigen::Vector3d(1.7042, -0.021, 1.8047)};
}

std::optional<PoseLayout> dataset_layout(const Fields& fields) {
  const std::size_t digits = is_whole_number(fields[0]) ? fields[0].size() : 0;
  if (fields.size() == matrix_columns && digits == ns_digits) return PoseLayout::mulran;
  if (fields.size() == matrix_columns && digits == us_digits) return PoseLayout::boreas;
  if (fields.size() == nclt_columns && digits == us_digits) return PoseLayout::nclt;
  if (fields.size() == newer_college_columns && digits > 0 && digits <= 10 &&
      is_whole_number(fields[1])) {
    return PoseLayout::newer_college;
  }
  if (fields.size() == spires_columns && is_whole_number(fields[1]) && is_whole_number(fields[2])) {
    return PoseLayout::spires;
  }
  return std::nullopt;
}

PoseRow dataset_row(const Fields& fields, PoseLayout layout) {
  require_columns(fields, columns_of(layout), columns_of(layout));
  switch (layout) {
    case PoseLayout::mulran:
      return mulran_row(fields);
    case PoseLayout::boreas:
      return boreas_row(fields);
    case PoseLayout::nclt:
      return nclt_row(fields);
    case PoseLayout::spires:
      return sec_nsec_row(fields, 1);
    case PoseLayout::apollo:
      return apollo_row(fields);
    default:
      return sec_nsec_row(fields, 0);
  }
}

}  // namespace kissmap
