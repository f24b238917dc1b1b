// SPDX-License-Identifier: MIT
#include "support/monte_carlo_localiser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "kissmap/error.hpp"
#include "support/distance_field.hpp"

namespace kissmap {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::uint64_t particle_stream = 0x50415254;

}  // namespace

MonteCarloLocaliser::MonteCarloLocaliser(const OccupancyPlan& plan,
                                         const LocaliserOptions& options,
                                         std::uint64_t seed)
    : plan_(plan),
      options_(options),
      random_{seed, particle_stream},
      distance_(distances_to_occupied(plan)) {
  if (std::ranges::count(plan_.cells, PlanCell::free) == 0 ||
      std::ranges::count(plan_.cells, PlanCell::occupied) == 0) {
    throw usage_error("localiser: the map has no free or no occupied cells");
  }
  scatter();
}

// Ten thousand particles lie half a metre apart and look in all directions: at first none is quite
// right, so the nearly right ones must not be punished. Shrinks by equal factors.
double MonteCarloLocaliser::deviation() const {
  constexpr int steps = 5;
  const int step = std::min(steps, scans_ * steps / std::max(1, options_.settling));
  const double ratio = options_.hit_deviation / options_.first_deviation;
  return options_.first_deviation * std::pow(ratio, static_cast<double>(step) / steps);
}

void MonteCarloLocaliser::make_field() {
  const double spread = 2.0 * deviation() * deviation();
  log_likelihood_.clear();
  for (const double distance : distance_) {
    const double hit = (1.0 - options_.miss_share) * std::exp(-distance * distance / spread);
    log_likelihood_.push_back(static_cast<float>(std::log(hit + options_.miss_share)));
  }
  log_outside_ = static_cast<float>(std::log(options_.miss_share));
}

void MonteCarloLocaliser::scatter() {
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < plan_.cells.size(); ++i) {
    if (plan_.cells[i] == PlanCell::free) free.push_back(i);
  }
  const auto width = static_cast<std::size_t>(plan_.width);
  for (int i = 0; i < options_.particles; ++i) {
    const auto pick =
        static_cast<std::size_t>(random_.uniform() * static_cast<double>(free.size()));
    const std::size_t cell = free[pick];
    Particle particle;
    particle.pose.x = plan_.origin.x() +
                      (static_cast<double>(cell % width) + random_.uniform()) * plan_.resolution;
    particle.pose.y = plan_.origin.y() +
                      (static_cast<double>(cell / width) + random_.uniform()) * plan_.resolution;
    particle.pose.yaw = random_.uniform(-pi, pi);
    particles_.push_back(particle);
  }
}

void MonteCarloLocaliser::update(const Pose2& before_from_now, const std::vector<float>& ranges) {
  const double before = scans_ > 0 ? deviation() : 0.0;
  ++scans_;
  if (deviation() != before) make_field();
  move(before_from_now);
  weigh(ranges);
  resample();
}

void MonteCarloLocaliser::move(const Pose2& before_from_now) {
  const double distance = std::hypot(before_from_now.x, before_from_now.y);
  const double turn = std::abs(std::remainder(before_from_now.yaw, 2.0 * pi));
  const double unsettled = deviation() - options_.hit_deviation;
  const double along = 0.08 * distance + 0.01 * turn + 0.004 + 0.15 * unsettled;
  const double heading = 0.08 * turn + 0.04 * distance + 0.004 + 0.1 * unsettled;
  for (Particle& particle : particles_) {
    Pose2 step = before_from_now;
    step.x += along * random_.normal();
    step.y += 0.5 * along * random_.normal();
    step.yaw += heading * random_.normal();
    particle.pose = particle.pose * step;
  }
}

// Ends of the beams in cells, as the robot sees them.
std::vector<Eigen::Vector2f> MonteCarloLocaliser::beam_ends(
    const std::vector<float>& ranges) const {
  std::vector<Eigen::Vector2f> ends;
  const std::size_t n = ranges.size();
  const std::size_t stride =
      std::max<std::size_t>(1, n / static_cast<std::size_t>(std::max(1, options_.beams)));
  for (std::size_t k = 0; k < n; k += stride) {
    const double range = static_cast<double>(ranges[k]);
    if (range <= 0.0 || range >= options_.max_range) continue;
    const double angle = -pi + 2.0 * pi * static_cast<double>(k) / static_cast<double>(n);
    const double cells = range / plan_.resolution;
    ends.emplace_back(static_cast<float>(cells * std::cos(angle)),
                      static_cast<float>(cells * std::sin(angle)));
  }
  return ends;
}

double MonteCarloLocaliser::log_likelihood(const Pose2& pose,
                                           const std::vector<Eigen::Vector2f>& ends) const {
  const auto x = static_cast<float>((pose.x - plan_.origin.x()) / plan_.resolution);
  const auto y = static_cast<float>((pose.y - plan_.origin.y()) / plan_.resolution);
  const auto c = static_cast<float>(std::cos(pose.yaw));
  const auto s = static_cast<float>(std::sin(pose.yaw));
  const auto width = static_cast<float>(plan_.width);
  const auto height = static_cast<float>(plan_.height);
  float sum = 0.0F;
  for (const Eigen::Vector2f& end : ends) {
    const float column = std::floor(x + c * end.x() - s * end.y());
    const float row = std::floor(y + s * end.x() + c * end.y());
    const bool inside = column >= 0.0F && row >= 0.0F && column < width && row < height;
    sum += inside ? log_likelihood_[plan_.index(static_cast<int>(column), static_cast<int>(row))]
                  : log_outside_;
  }
  const int column = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  const bool free =
      plan_.contains(column, row) && plan_.cells[plan_.index(column, row)] == PlanCell::free;
  constexpr double not_free = -3.0;  // robots stand in free space, but maps have flaws
  return options_.trust * static_cast<double>(sum) + (free ? 0.0 : not_free);
}

void MonteCarloLocaliser::weigh(const std::vector<float>& ranges) {
  const std::vector<Eigen::Vector2f> ends = beam_ends(ranges);
  double best = -std::numeric_limits<double>::infinity();
  for (Particle& particle : particles_) {
    particle.weight = std::log(particle.weight) + log_likelihood(particle.pose, ends);
    best = std::max(best, particle.weight);
  }
  double total = 0.0;
  for (Particle& particle : particles_) {
    particle.weight = std::exp(particle.weight - best);
    total += particle.weight;
  }
  for (Particle& particle : particles_) {
    particle.weight = std::max(particle.weight / total, 1e-300);
  }
}

// Enough for an error of 5 % (Kullback-Leibler) with 99 % probability, by the number of bins of
// half a metre and 15 degrees that hold particles.
std::size_t MonteCarloLocaliser::needed() const {
  std::vector<std::tuple<int, int, int>> bins;
  for (const Particle& particle : particles_) {
    bins.emplace_back(
        static_cast<int>(std::floor(2.0 * particle.pose.x)),
        static_cast<int>(std::floor(2.0 * particle.pose.y)),
        static_cast<int>(std::floor(std::remainder(particle.pose.yaw, 2.0 * pi) * 12.0 / pi)));
  }
  std::ranges::sort(bins);
  const auto used = static_cast<double>(std::unique(bins.begin(), bins.end()) - bins.begin());
  if (used < 2.0) return static_cast<std::size_t>(options_.least_particles);
  constexpr double error = 0.05;
  constexpr double quantile = 2.326;
  const double a = 2.0 / (9.0 * (used - 1.0));
  const double count =
      (used - 1.0) / (2.0 * error) * std::pow(1.0 - a + std::sqrt(a) * quantile, 3);
  return static_cast<std::size_t>(std::clamp(count,
                                             static_cast<double>(options_.least_particles),
                                             static_cast<double>(options_.particles)));
}

// Systematic resampling, once the weights have become uneven.
void MonteCarloLocaliser::resample() {
  double squares = 0.0;
  for (const Particle& particle : particles_) squares += particle.weight * particle.weight;
  if (1.0 / squares > 0.5 * static_cast<double>(particles_.size())) return;
  const auto draw = [this](std::size_t count) {
    std::vector<Particle> drawn;
    const double step = 1.0 / static_cast<double>(count);
    double at = step * random_.uniform();
    double passed = 0.0;
    for (const Particle& particle : particles_) {
      passed += particle.weight;
      for (; at < passed && drawn.size() < count; at += step)
        drawn.push_back({particle.pose, step});
    }
    return drawn;
  };
  particles_ = draw(particles_.size());
  const std::size_t count = needed();
  if (count != particles_.size()) particles_ = draw(count);
}

// The heaviest particle of the likeliest bin of a metre and 30 degrees.
std::size_t MonteCarloLocaliser::likeliest() const {
  struct Bin {
    double weight = 0.0;
    std::size_t heaviest = 0;
  };
  std::map<std::tuple<int, int, int>, Bin> bins;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const auto [pose, weight] = particles_[i];
    const double turn = std::remainder(pose.yaw, 2.0 * pi);
    const auto place = std::tuple(static_cast<int>(std::floor(pose.x)),
                                  static_cast<int>(std::floor(pose.y)),
                                  static_cast<int>(std::floor(turn * 6.0 / pi)));
    Bin& bin = bins.try_emplace(place, Bin{0.0, i}).first->second;
    bin.weight += weight;
    if (weight > particles_[bin.heaviest].weight) bin.heaviest = i;
  }
  return std::ranges::max_element(bins, {}, [](const auto& bin) { return bin.second.weight; })
      ->second.heaviest;
}

Pose2 MonteCarloLocaliser::map_from_robot() const {
  const Pose2 middle = particles_[likeliest()].pose;
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  for (const Particle& particle : particles_) {
    const Pose2& pose = particle.pose;
    const double turn = std::remainder(pose.yaw - middle.yaw, 2.0 * pi);
    if (std::hypot(pose.x - middle.x, pose.y - middle.y) > 1.0 || std::abs(turn) > pi / 6) continue;
    sum += particle.weight * Eigen::Vector4d(pose.x, pose.y, turn, 1.0);
  }
  return {sum[0] / sum[3], sum[1] / sum[3], middle.yaw + sum[2] / sum[3]};
}

}  // namespace kissmap
