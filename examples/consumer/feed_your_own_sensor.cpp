// SPDX-License-Identifier: MIT
// Scans from anywhere: fill a Scan, hand it to the Mapper, read the pose. Links kissmap::core only.
#include <cmath>
#include <cstdio>
#include <kissmap/mapping/mapper.hpp>

namespace {

// Stands in for your driver: a sensor moving at 1 m/s along a street lined with posts.
kissmap::Scan record_sweep(int number) {
  kissmap::Scan scan;
  scan.stamp_ns = std::int64_t{number} * 100'000'000;
  const float travelled = 0.1F * static_cast<float>(number);
  for (int post = -20; post < 60; ++post) {
    const float x = 2.0F * static_cast<float>(post) + 0.7F * std::sin(static_cast<float>(post));
    for (int k = 0; k < 40; ++k) {
      const float side = post % 2 == 0 ? 5.0F : -4.0F;
      scan.points.emplace_back(x - travelled, side, -1.0F + 0.1F * static_cast<float>(k));
    }
  }
  return scan;
}

}  // namespace

int main() {
  kissmap::ThreadPool pool;
  kissmap::Mapper mapper(kissmap::OdometryOptions{}, kissmap::LocalMapOptions{}, pool);
  double x = 0.0;
  for (int number = 0; number < 50; ++number) {
    const kissmap::MapperStep step = mapper.add(record_sweep(number));
    if (const auto* scan = std::get_if<kissmap::MappedScan>(&step.scan)) {
      x = scan->map_from_lidar.translation.x();
    }
  }
  std::printf("travelled %.2f m of 4.90 m\n", x);
  return std::abs(x - 4.9) < 0.1 ? 0 : 1;
}
