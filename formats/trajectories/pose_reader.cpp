// SPDX-License-Identifier: MIT
#include "formats/trajectories/pose_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/text/lines.hpp"
#include "formats/text/stamps.hpp"
#include "formats/trajectories/dataset_poses.hpp"
#include "formats/trajectories/pose_fields.hpp"

namespace kissmap {
namespace {

constexpr std::size_t tum_columns = 8;
constexpr std::size_t kitti_columns = 12;
constexpr std::size_t least_euroc_columns = 8;

PoseRow tum_row(std::string_view line) {
  const Fields fields = split_at_spaces(line);
  require_columns(fields, tum_columns, tum_columns);
  // HeLiPR has whole nanoseconds.
  auto stamp = nanoseconds_from_digits(fields[0]);
  if (!stamp) stamp = nanoseconds_from_seconds(fields[0]);
  if (!stamp) {
    throw std::invalid_argument(in_quotes(fields[0]) +
                                " is no stamp in seconds; nanoseconds have to be divided by 1e9");
  }
  const Eigen::Quaterniond q(
      number(fields[7]), number(fields[4]), number(fields[5]), number(fields[6]));
  return {stamp, {unit_quaternion(q), position(std::span(fields).subspan(1))}};
}

PoseRow euroc_row(std::string_view line) {
  const Fields fields = split_at_commas(line);
  require_columns(fields, least_euroc_columns, fields.size());
  std::int64_t stamp = 0;
  const char* end = fields[0].data() + fields[0].size();
  const auto [stop, error] = std::from_chars(fields[0].data(), end, stamp);
  if (error != std::errc() || stop != end) {
    throw std::invalid_argument(in_quotes(fields[0]) + " is no stamp in whole nanoseconds");
  }
  const Eigen::Quaterniond q(
      number(fields[4]), number(fields[5]), number(fields[6]), number(fields[7]));
  return {stamp, {unit_quaternion(q), position(std::span(fields).subspan(1))}};
}

// Without a stamp, or with one in front.
PoseRow position_row(std::string_view line) {
  const Fields fields = split_at_spaces(line);
  require_columns(fields, 3, 4);
  if (fields.size() == 3) return {std::nullopt, {Eigen::Quaterniond::Identity(), position(fields)}};
  const auto stamp = nanoseconds_from_seconds(fields[0]);
  if (!stamp) throw std::invalid_argument(in_quotes(fields[0]) + " is no stamp in seconds");
  return {stamp, {Eigen::Quaterniond::Identity(), position(std::span(fields).subspan(1))}};
}

PoseRow kitti_row(std::string_view line) {
  const Fields fields = split_at_spaces(line);
  require_columns(fields, kitti_columns, kitti_columns);
  return {std::nullopt, pose_of_rows(fields)};
}

}  // namespace

std::optional<PoseLayout> layout_of(std::string_view line) {
  if (line.find(',') != std::string_view::npos) {
    const auto fields = split_at_commas(line);
    if (const auto layout = dataset_layout(fields)) return layout;
    return fields.size() >= least_euroc_columns ? std::optional(PoseLayout::euroc) : std::nullopt;
  }
  const std::size_t columns = split_at_spaces(line).size();
  if (columns == tum_columns) return PoseLayout::tum;
  if (columns == kitti_columns) return PoseLayout::kitti;
  if (columns == apollo_columns) return PoseLayout::apollo;
  if (columns == 3 || columns == 4) return PoseLayout::positions;
  return std::nullopt;
}

const char* name_of(PoseLayout layout) {
  switch (layout) {
    case PoseLayout::tum:
      return "TUM";
    case PoseLayout::kitti:
      return "KITTI";
    case PoseLayout::mulran:
      return "MulRan";
    case PoseLayout::boreas:
      return "Boreas";
    case PoseLayout::nclt:
      return "NCLT";
    case PoseLayout::newer_college:
      return "Newer College";
    case PoseLayout::spires:
      return "Oxford Spires";
    case PoseLayout::apollo:
      return "Apollo-SouthBay";
    case PoseLayout::positions:
      return "positions";
    case PoseLayout::euroc:
      break;
  }
  return "EuRoC";
}

PoseRow read_pose_row(std::string_view line, PoseLayout layout) {
  switch (layout) {
    case PoseLayout::tum:
      return tum_row(line);
    case PoseLayout::kitti:
      return kitti_row(line);
    case PoseLayout::euroc:
      return euroc_row(line);
    case PoseLayout::positions:
      return position_row(line);
    case PoseLayout::apollo:
      return dataset_row(split_at_spaces(line), layout);
    default:
      return dataset_row(split_at_commas(line), layout);
  }
}

bool is_column_names(std::string_view line) {
  const std::string_view text = trimmed(line);
  const bool begins_with_letter =
      !text.empty() && ((text[0] >= 'A' && text[0] <= 'Z') || (text[0] >= 'a' && text[0] <= 'z'));
  return begins_with_letter && text.find(',') != std::string_view::npos &&
         !text.starts_with("nan") && !text.starts_with("inf");
}

bool is_unknown_pose(std::string_view line, PoseLayout layout) {
  if (layout != PoseLayout::nclt) return false;
  const auto fields = split_at_commas(line);
  return fields.size() > 1 && (fields[1] == "nan" || fields[1] == "NaN");
}

}  // namespace kissmap
