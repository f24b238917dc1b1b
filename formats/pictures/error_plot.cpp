// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "formats/pictures/axes.hpp"
#include "formats/pictures/canvas.hpp"
#include "kissmap/formats/evaluation_report.hpp"

namespace kissmap {
namespace {

constexpr int width = 1600;
constexpr int panel_height = 640;
constexpr int margin = 90;  // left of and below a diagram, for its numbers
constexpr int legend_row = 26;
constexpr int text_unit = 2;
constexpr std::size_t longest_name = 80;

const Colour background(1.0F, 1.0F, 1.0F);
const Colour ink(0.15F, 0.16F, 0.20F);
const Colour reference_colour(0.55F, 0.56F, 0.60F);

// Told apart by readers who do not see red and green (after Okabe and Ito).
const std::array<Colour, 7> colours = {Colour(0.00F, 0.45F, 0.70F),
                                       Colour(0.84F, 0.37F, 0.00F),
                                       Colour(0.00F, 0.62F, 0.45F),
                                       Colour(0.80F, 0.47F, 0.65F),
                                       Colour(0.90F, 0.62F, 0.00F),
                                       Colour(0.34F, 0.71F, 0.91F),
                                       Colour(0.45F, 0.25F, 0.10F)};

const Colour& colour_of(std::size_t estimate_idx) {
  return colours[estimate_idx % colours.size()];
}

std::vector<Eigen::Vector3d> positions(const std::vector<Rigid3>& poses) {
  std::vector<Eigen::Vector3d> result;
  result.reserve(poses.size());
  for (const Rigid3& pose : poses) result.push_back(pose.translation);
  return result;
}

/// Positions of all trajectories in the frame of the reference; the reference comes first.
std::vector<std::vector<Eigen::Vector3d>> all_positions(const EvaluationReport& report) {
  std::vector<std::vector<Eigen::Vector3d>> all{positions(report.reference_poses)};
  for (const EvaluatedTrajectory& estimate : report.estimates) {
    const Evaluation& e = estimate.evaluation;
    all.push_back(positions(transformed(e.reference_from_map, e.pairs.estimate)));
  }
  return all;
}

std::array<Interval, 3> ranges_of(const std::vector<Eigen::Vector3d>& points) {
  std::array<Interval, 3> ranges;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    ranges[axis] = {points.front()[i], points.front()[i]};
    for (const Eigen::Vector3d& point : points) ranges[axis].include(point[i]);
  }
  return ranges;
}

/// The two axes of the widest view, in their order.
std::pair<std::size_t, std::size_t> widest_axes(const std::array<Interval, 3>& ranges) {
  std::size_t narrow = 2;
  for (const std::size_t axis : {std::size_t{1}, std::size_t{0}}) {
    if (ranges[axis].size() < ranges[narrow].size()) narrow = axis;
  }
  return {narrow == 0 ? 1 : 0, narrow == 2 ? 1 : 2};
}

void draw_views(Canvas& canvas, const Frame& frame, const EvaluationReport& report) {
  const auto trajectories = all_positions(report);
  const auto [right, up] = widest_axes(ranges_of(trajectories.front()));
  Interval x = ranges_of(trajectories.front())[right];
  Interval y = ranges_of(trajectories.front())[up];
  for (const auto& points : trajectories) {
    const auto ranges = ranges_of(points);
    x.include(ranges[right].low);
    x.include(ranges[right].high);
    y.include(ranges[up].low);
    y.include(ranges[up].high);
  }
  const Axes axes = fit_axes(frame, x, y, true);
  constexpr const char* labels[] = {"x (m)", "y (m)", "z (m)"};
  draw_axes(canvas, axes, labels[right], labels[up]);
  for (std::size_t i = 0; i < trajectories.size(); ++i) {
    std::vector<Eigen::Vector2f> line;
    for (const Eigen::Vector3d& p : trajectories[i]) {
      line.push_back(
          axes.pixel_from(p[static_cast<Eigen::Index>(right)], p[static_cast<Eigen::Index>(up)]));
    }
    canvas.draw_line(line, i == 0 ? 2.0F : 0.9F, i == 0 ? reference_colour : colour_of(i - 1));
  }
}

void draw_errors(Canvas& canvas, const Frame& frame, const EvaluationReport& report) {
  Interval distance{0.0, 0.0};
  Interval error{0.0, 0.0};
  for (const EvaluatedTrajectory& estimate : report.estimates) {
    distance.include(estimate.evaluation.distances.back());
    error.include(estimate.evaluation.absolute_translation.max);
  }
  Axes axes = fit_axes(frame, distance, error, false);
  axes.x.low = 0.0;
  axes.y.low = 0.0;
  draw_axes(canvas, axes, "distance along the reference (m)", "error of the position (m)");
  for (std::size_t i = 0; i < report.estimates.size(); ++i) {
    const Evaluation& e = report.estimates[i].evaluation;
    std::vector<Eigen::Vector2f> line;
    for (std::size_t k = 0; k < e.distances.size(); ++k) {
      line.push_back(axes.pixel_from(e.distances[k], e.absolute.translation[k]));
    }
    canvas.draw_line(line, 0.9F, colour_of(i));
  }
}

void draw_legend_row(Canvas& canvas,
                     int row,
                     const Colour& colour,
                     const std::string& name,
                     const std::string& more) {
  const int y = 20 + row * legend_row;
  canvas.fill_rectangle(margin, y + 3, margin + 39, y + 6, colour);
  const bool cut = name.size() > longest_name;
  const std::string shown = cut ? ".." + name.substr(name.size() - longest_name) : name;
  canvas.draw_text(margin + 52, y, text_unit, shown + "   " + more, ink);
}

void draw_legend(Canvas& canvas, const EvaluationReport& report) {
  draw_legend_row(canvas, 0, reference_colour, report.reference.name, "reference");
  for (std::size_t i = 0; i < report.estimates.size(); ++i) {
    char figures[96];
    std::snprintf(figures,
                  sizeof figures,
                  "ATE RMSE %.3f m",
                  report.estimates[i].evaluation.absolute_translation.rmse);
    draw_legend_row(
        canvas, static_cast<int>(i) + 1, colour_of(i), report.estimates[i].about.name, figures);
  }
}

}  // namespace

Picture draw_evaluation(const EvaluationReport& report) {
  const int top = 20 + legend_row * (static_cast<int>(report.estimates.size()) + 1) + 40;
  const int bottom = top + panel_height;
  Canvas canvas(width, bottom + 70, background);
  draw_legend(canvas, report);
  draw_views(canvas, {margin, top, width / 2 - 20, bottom}, report);
  draw_errors(canvas, {width / 2 + margin, top, width - 30, bottom}, report);
  return canvas.picture();
}

}  // namespace kissmap
