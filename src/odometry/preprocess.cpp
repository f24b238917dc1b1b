// SPDX-License-Identifier: MIT
#include "kissmap/odometry/preprocess.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kissmap {
namespace {

constexpr std::size_t points_per_chunk = 16384;
// More chunks than this are worked in several points_per_chunk each; keeps the counts on the stack.
constexpr std::size_t max_chunks = 64;

}  // namespace

SweepMotion::SweepMotion(const Rigid3& start_from_end, TimeSpan span)
    : first_(span.first),
      knots_per_second_(
          static_cast<float>(intervals / (static_cast<double>(span.last) - span.first))) {
  const Twist twist = log(start_from_end);
  for (int i = 0; i <= intervals; ++i) {
    const double s = static_cast<double>(i) / intervals;
    knots_[i] = exp((s - 1.0) * twist).matrix().topRows<3>().cast<float>();
  }
}

Eigen::Vector3f SweepMotion::to_sweep_end(const Eigen::Vector3f& point, float time_offset) const {
  const float position =
      std::clamp((time_offset - first_) * knots_per_second_, 0.0F, static_cast<float>(intervals));
  const int knot = std::min(static_cast<int>(position), intervals - 1);
  const float share = position - static_cast<float>(knot);
  const Eigen::Matrix<float, 3, 4>& a = knots_[knot];
  const Eigen::Matrix<float, 3, 4>& b = knots_[knot + 1];
  const Eigen::Vector3f from_a = a.leftCols<3>() * point + a.col(3);
  const Eigen::Vector3f from_b = b.leftCols<3>() * point + b.col(3);
  return from_a + share * (from_b - from_a);
}

std::optional<SweepMotion> sweep_motion(const Scan& scan, const Rigid3& start_from_end) {
  if (scan.compensation == Compensation::yes) return std::nullopt;
  const std::optional<TimeSpan> span = time_span(scan);
  if (!span || !(span->last > span->first)) return std::nullopt;
  return SweepMotion(start_from_end, *span);
}

void deskew_and_crop(const Scan& scan,
                     const std::optional<SweepMotion>& motion,
                     double min_range,
                     double max_range,
                     ThreadPool& pool,
                     std::vector<Eigen::Vector3f>& kept) {
  const std::size_t n = scan.points.size();
  const std::size_t per_chunk = std::max(points_per_chunk, (n + max_chunks - 1) / max_chunks);
  const std::size_t chunks = (n + per_chunk - 1) / per_chunk;
  const auto min_squared = static_cast<float>(min_range * min_range);
  const auto max_squared = static_cast<float>(max_range * max_range);
  kept.resize(n);
  std::array<std::size_t, max_chunks> counts{};
  pool.for_each_chunk(chunks, [&](std::size_t chunk) {
    const std::size_t begin = chunk * per_chunk;
    const std::size_t end = std::min(n, begin + per_chunk);
    std::size_t out = begin;
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3f point =
          motion ? motion->to_sweep_end(scan.points[i], scan.time_offsets[i]) : scan.points[i];
      const float squared = point.squaredNorm();
      kept[out] = point;
      out += static_cast<std::size_t>(squared > min_squared && squared < max_squared);
    }
    counts[chunk] = out - begin;
  });
  std::size_t total = 0;
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
    const auto first = kept.begin() + static_cast<std::ptrdiff_t>(chunk * per_chunk);
    std::copy_n(first, counts[chunk], kept.begin() + static_cast<std::ptrdiff_t>(total));
    total += counts[chunk];
  }
  kept.resize(total);
}

}  // namespace kissmap
