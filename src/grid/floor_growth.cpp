// SPDX-License-Identifier: MIT
#include "grid/floor_growth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <vector>

namespace kissmap {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
constexpr double step_height = 0.08;  // m, between neighbouring surfaces of one floor
constexpr double least_step = 0.03;   // m, to what may be a wall
constexpr double steepest = 0.25;     // slope
constexpr double widest_gap = 1.25;   // m, without any floor seen
constexpr double step_cost = 5.0;     // m of way for a metre up or down
constexpr double under_path = 0.6;    // m, a pose stands on what is this near
constexpr double most_carried = 0.4;  // m, a hand-held sensor goes up and down
constexpr double max_height = 5.0;    // m, of a sensor above its floor
constexpr double height_bin = 0.05;   // m

/// The surfaces by column, to find those of a place.
class Columns {
 public:
  Columns(std::span<const FloorSample> samples, double cell_size)
      : samples_(samples), cell_size_(cell_size) {
    if (samples.empty()) return;
    const auto [low_x, high_x] = std::ranges::minmax(samples, {}, &FloorSample::x);
    const auto [low_y, high_y] = std::ranges::minmax(samples, {}, &FloorSample::y);
    field_.first_x = low_x.x;
    field_.first_y = low_y.y;
    field_.width = high_x.x - low_x.x + 1;
    field_.height = high_y.y - low_y.y + 1;
    field_.cell_size = cell_size;
    const std::size_t cells =
        static_cast<std::size_t>(field_.width) * static_cast<std::size_t>(field_.height);
    field_.z.assign(cells, unknown);
    begin_.assign(cells + 1, 0);
    order_.resize(samples.size());
    for (const FloorSample& sample : samples) ++begin_[field_.index(sample.x, sample.y) + 1];
    for (std::size_t i = 1; i <= cells; ++i) begin_[i] += begin_[i - 1];
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
      order_[next[field_.index(samples[i].x, samples[i].y)]++] = i;
    }
  }

  const HeightField& blank_field() const { return field_; }
  const FloorSample& sample(std::uint32_t idx) const { return samples_[idx]; }

  bool holds(std::int32_t x, std::int32_t y) const {
    return x >= field_.first_x && y >= field_.first_y && x - field_.first_x < field_.width &&
           y - field_.first_y < field_.height;
  }
  std::span<const std::uint32_t> at(std::int32_t x, std::int32_t y) const {
    if (!holds(x, y)) return {};
    const std::size_t cell = field_.index(x, y);
    return std::span(order_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
  }

  /// Calls with each surface less than `reach` [m] aside of a place.
  void around(const Eigen::Vector3d& place,
              double reach,
              const std::function<void(std::uint32_t)>& call) const {
    const auto cell = [this](double v) {
      return static_cast<std::int32_t>(std::floor(v / cell_size_));
    };
    for (std::int32_t x = cell(place.x() - reach); x <= cell(place.x() + reach); ++x) {
      for (std::int32_t y = cell(place.y() - reach); y <= cell(place.y() + reach); ++y) {
        for (const std::uint32_t idx : at(x, y)) call(idx);
      }
    }
  }

 private:
  std::span<const FloorSample> samples_;
  double cell_size_;
  HeightField field_;
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> order_;
};

struct Step {
  std::int32_t x;
  std::int32_t y;
  double length;  ///< m
};

std::vector<Step> steps_of(double cell_size) {
  std::vector<Step> steps;
  const int reach = std::max(1, static_cast<int>(widest_gap / cell_size));
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      const double length = std::hypot(x, y) * cell_size;
      const bool neighbor = std::abs(x) <= 1 && std::abs(y) <= 1;
      if ((x != 0 || y != 0) && (neighbor || length <= widest_gap)) steps.push_back({x, y, length});
    }
  }
  return steps;
}

class Growth {
 public:
  Growth(const Columns& columns, std::size_t samples, double cell_size)
      : columns_(columns),
        steps_(steps_of(cell_size)),
        field_(columns.blank_field()),
        cost_(samples, std::numeric_limits<double>::infinity()) {}

  void seed(std::uint32_t idx, double cost) { offer(idx, cost); }

  HeightField grow() {
    while (!open_.empty()) {
      const auto [cost, idx] = open_.top();
      open_.pop();
      if (cost > cost_[idx]) continue;
      const FloorSample& from = columns_.sample(idx);
      float& z = field_.z[field_.index(from.x, from.y)];
      if (!std::isnan(z)) continue;  // this column has its floor
      z = from.z;
      if (from.below_others) continue;  // it may be a wall whose foot is hidden
      for (const Step& step : steps_) go(from, cost, step);
    }
    return std::move(field_);
  }

 private:
  void go(const FloorSample& from, double cost, const Step& step) {
    const std::int32_t x = from.x + step.x;
    const std::int32_t y = from.y + step.y;
    if (!columns_.holds(x, y) || !std::isnan(field_.z[field_.index(x, y)])) return;
    for (const std::uint32_t idx : columns_.at(x, y)) {
      const FloorSample& to = columns_.sample(idx);
      const double rise = std::abs(static_cast<double>(to.z - from.z));
      const double most = to.below_others ? least_step : step_height + steepest * step.length;
      if (rise > most) continue;
      offer(idx,
            cost + step.length * step.length / columns_.blank_field().cell_size + step_cost * rise);
    }
  }

  void offer(std::uint32_t idx, double cost) {
    if (cost >= cost_[idx]) return;
    cost_[idx] = cost;
    open_.emplace(cost, idx);
  }

  using Open = std::pair<double, std::uint32_t>;
  const Columns& columns_;
  std::vector<Step> steps_;
  HeightField field_;
  std::vector<double> cost_;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open_;
};

}  // namespace

double sensor_height(const SensorPath& path,
                     std::span<const FloorSample> samples,
                     double cell_size) {
  const Columns columns(samples, cell_size);
  std::array<double, static_cast<std::size_t>(max_height / height_bin) + 2> bins{};
  for (const Eigen::Vector3d& sensor : path) {
    columns.around(sensor, under_path, [&](std::uint32_t idx) {
      const double height = sensor.z() - static_cast<double>(columns.sample(idx).z);
      if (height <= 0.0 || height >= max_height) return;
      bins[static_cast<std::size_t>(height / height_bin)] +=
          std::min(20.0, static_cast<double>(columns.sample(idx).weight));
    });
  }
  double best = 0.0;
  double height = 0.0;
  for (std::size_t i = 1; i + 1 < bins.size(); ++i) {
    const double sum = bins[i - 1] + bins[i] + bins[i + 1];
    if (sum <= best) continue;
    best = sum;
    height = height_bin * (static_cast<double>(i) + 0.5 + (bins[i + 1] - bins[i - 1]) / sum);
  }
  return height;
}

HeightField grow_floor(const SensorPath& path,
                       std::span<const FloorSample> samples,
                       double cell_size,
                       double sensor_height) {
  const Columns columns(samples, cell_size);
  Growth growth(columns, samples.size(), cell_size);
  for (const Eigen::Vector3d& sensor : path) {
    columns.around(sensor, under_path, [&](std::uint32_t idx) {
      const double off =
          std::abs(sensor.z() - sensor_height - static_cast<double>(columns.sample(idx).z));
      if (off < std::min(most_carried, sensor_height / 3.0)) growth.seed(idx, step_cost * off);
    });
  }
  return growth.grow();
}

}  // namespace kissmap
