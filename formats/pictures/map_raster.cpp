// SPDX-License-Identifier: MIT
#include "formats/pictures/map_raster.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "kissmap/formats/session.hpp"

namespace kissmap {
namespace {

constexpr double max_distance = 120.0;     // m around the trajectory
constexpr double cut_share = 0.005;        // of the surfels at each side, in x and in y
constexpr double cut_height_share = 0.02;  // of the surfels at each end of the colour ramp
constexpr double min_pixel_size = 0.04;    // m; surfels are decimetres apart
constexpr double margin = 0.03;            // of the longer side
constexpr double margin_below = 0.07;      // room for the scale bar
// Discs of neighbours half a metre apart blend into an even surface.
constexpr float surfel_radius = 0.6F;  // m

using SurfelVisitor =
    std::function<void(const Eigen::Vector3d& mean, const Eigen::Vector3d& normal)>;

// Calls `visit` with every surfel in the map frame; one local map in memory at a time.
void for_each_surfel(const std::filesystem::path& session,
                     const std::vector<LocalMap>& local_maps,
                     const SurfelVisitor& visit) {
  for (const LocalMap& map : local_maps) {
    const SurfelCloud surfels = read_local_map_surfels(session, map.id);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
      visit(map.map_from_local_map * surfels.means[i].cast<double>(),
            map.map_from_local_map.rotation * surfels.normals[i].cast<double>());
    }
  }
}

struct Interval {
  double low = 0.0;
  double high = 0.0;
  double length() const { return high - low; }
};

// Quantiles of values in a known range, in bounded memory, to a 4096th of the range.
class Histogram {
 public:
  explicit Histogram(Interval range) : range_(range), counts_(bins, 0) {}

  void add(double value) {
    const double place = (value - range_.low) / range_.length() * static_cast<double>(bins);
    ++counts_[static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(bins - 1)))];
  }

  Interval without_ends(double share) const {
    const std::uint64_t total = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
    const auto cut = static_cast<std::uint64_t>(share * static_cast<double>(total));
    return {edge(bin_above(counts_.begin(), counts_.end(), cut)),
            edge(bins - bin_above(counts_.rbegin(), counts_.rend(), cut))};
  }

 private:
  static constexpr std::size_t bins = 4096;

  // Bins passed from one end before more than `cut` values are.
  template <typename Iterator>
  static std::size_t bin_above(Iterator begin, Iterator end, std::uint64_t cut) {
    std::uint64_t passed = 0;
    const auto bin = std::find_if(begin, end, [&](std::uint64_t n) { return (passed += n) > cut; });
    return bin == end ? 0 : static_cast<std::size_t>(bin - begin);
  }

  double edge(std::size_t bin) const {
    return range_.low + range_.length() * static_cast<double>(bin) / static_cast<double>(bins);
  }

  Interval range_;
  std::vector<std::uint64_t> counts_;
};

Interval bounds_of(const std::vector<Eigen::Vector3d>& points, Eigen::Index axis) {
  if (points.empty()) return {};
  Interval bounds{points.front()[axis], points.front()[axis]};
  for (const Eigen::Vector3d& point : points) {
    bounds.low = std::min(bounds.low, point[axis]);
    bounds.high = std::max(bounds.high, point[axis]);
  }
  return bounds;
}

Interval widened(Interval interval, double by) {
  return {interval.low - by, interval.high + by};
}

Interval united(Interval a, Interval b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

bool holds(Interval interval, double value) {
  return interval.low <= value && value <= interval.high;
}

int pixel_count(double length, double pixel_size, int max_pixels) {
  return std::clamp(static_cast<int>(std::ceil(length / pixel_size)), 1, max_pixels);
}

MapView fit_view(Interval x, Interval y, Interval z, int max_pixels) {
  const double room = std::max({x.length(), y.length(), 1.0});
  x = widened(x, margin * room);
  y = {y.low - margin_below * room, y.high + margin * room};
  MapView view;
  view.corner = {x.low, y.low};
  view.pixel_size = std::max(std::max(x.length(), y.length()) / max_pixels, min_pixel_size);
  view.width = pixel_count(x.length(), view.pixel_size, max_pixels);
  view.height = pixel_count(y.length(), view.pixel_size, max_pixels);
  view.low = z.low;
  view.high = std::max(z.high, z.low + 1.0);
  return view;
}

// A surfel is a disc in space. Seen from above it is an ellipse, which keeps walls thin.
class SurfelPainter {
 public:
  SurfelPainter(const MapView& view, MapRaster& raster) : view_(view), raster_(raster) {
    radius_ = std::max(surfel_radius / static_cast<float>(view.pixel_size), 0.7F);
  }

  void paint(const Eigen::Vector3d& mean, const Eigen::Vector3d& normal) {
    const Eigen::Vector2f centre = view_.pixel_from_map(mean.head<2>());
    if (!is_near(centre)) return;
    const Eigen::Vector2f slope = Eigen::Vector2d(normal.x(), -normal.y()).cast<float>();
    const Eigen::Vector2f across = slope.norm() > 1e-3F ? slope.normalized() : slope;
    const float half_thickness = std::max(radius_ * std::abs(static_cast<float>(normal.z())), 0.7F);
    const auto reach = static_cast<int>(std::ceil(radius_));
    const Eigen::Vector2i middle = centre.array().round().cast<int>();
    for (int y = middle.y() - reach; y <= middle.y() + reach; ++y) {
      for (int x = middle.x() - reach; x <= middle.x() + reach; ++x) {
        const Eigen::Vector2f d = Eigen::Vector2i(x, y).cast<float>() - centre;
        const float u = d.dot(across);
        const float distance2 = (d.squaredNorm() - u * u) / (radius_ * radius_) +
                                u * u / (half_thickness * half_thickness);
        if (distance2 <= 1.0F) add(x, y, std::exp(-2.0F * distance2), static_cast<float>(mean.z()));
      }
    }
  }

 private:
  bool is_near(const Eigen::Vector2f& centre) const {
    return (centre.array() >= -radius_).all() &&
           centre.x() < static_cast<float>(view_.width) + radius_ &&
           centre.y() < static_cast<float>(view_.height) + radius_;
  }

  void add(int x, int y, float weight, float height) {
    if (x < 0 || y < 0 || x >= view_.width || y >= view_.height) return;
    const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width) +
                    static_cast<std::size_t>(x);
    raster_.density[at] += weight;
    raster_.height[at] += weight * height;
  }

  const MapView& view_;
  MapRaster& raster_;
  float radius_ = 1.0F;  // pixels
};

}  // namespace

MapView choose_view(const std::filesystem::path& session,
                    const std::vector<LocalMap>& local_maps,
                    const std::vector<Eigen::Vector3d>& trajectory,
                    int max_pixels) {
  const Interval path_x = bounds_of(trajectory, 0);
  const Interval path_y = bounds_of(trajectory, 1);
  const Interval near_x = widened(path_x, max_distance);
  const Interval near_y = widened(path_y, max_distance);
  Histogram x(near_x);
  Histogram y(near_y);
  Histogram z(widened(bounds_of(trajectory, 2), max_distance));
  bool any = false;
  for_each_surfel(session, local_maps, [&](const Eigen::Vector3d& mean, const Eigen::Vector3d&) {
    if (!holds(near_x, mean.x()) || !holds(near_y, mean.y())) return;
    x.add(mean.x());
    y.add(mean.y());
    z.add(mean.z());
    any = true;
  });
  if (!any) return fit_view(path_x, path_y, bounds_of(trajectory, 2), max_pixels);
  return fit_view(united(path_x, x.without_ends(cut_share)),
                  united(path_y, y.without_ends(cut_share)),
                  z.without_ends(cut_height_share),
                  max_pixels);
}

MapRaster draw_surfels(const std::filesystem::path& session,
                       const std::vector<LocalMap>& local_maps,
                       const MapView& view) {
  const std::size_t pixels =
      static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  MapRaster raster{std::vector<float>(pixels, 0.0F), std::vector<float>(pixels, 0.0F)};
  SurfelPainter painter(view, raster);
  for_each_surfel(session, local_maps, [&](const Eigen::Vector3d& mean, const Eigen::Vector3d& n) {
    painter.paint(mean, n);
  });
  for (std::size_t i = 0; i < pixels; ++i) {
    if (raster.density[i] > 0.0F) raster.height[i] /= raster.density[i];
  }
  return raster;
}

}  // namespace kissmap
