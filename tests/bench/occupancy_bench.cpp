// SPDX-License-Identifier: MIT
// Occupancy engines beside each other, on one core and in one run: a 64 x 1024 sensor driving
// through a hall, 50 m range. Prints seconds a scan, memory, and the ratios.
//   occupancy_bench [voxel size in m, default 0.2] [scans, default 100] [octomap scans, default 3]
#include <octomap/OcTree.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <string>

#include "kissmap/occupancy/occupancy_map.hpp"
#ifdef KISSMAP_BONXAI
#include "bonxai_map/probabilistic_map.hpp"
#endif

namespace kissmap {
namespace {

constexpr float max_range = 50.0F;

struct Box {
  Eigen::Vector3f low, high;
};

struct SimulatedScan {
  Eigen::Vector3f sensor;
  std::vector<Eigen::Vector3f> ends;  // map frame
  std::vector<std::uint8_t> is_hit;
};

/// Distance along a unit direction to what is met first in a hall of 90 x 60 x 10 m with shelves.
class Hall {
 public:
  Hall() {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3f low(90 * unit(random) - 45, 60 * unit(random) - 30, 0.0F);
      if (std::abs(low.y()) < 4.0F) continue;  // the aisle driven along
      const Eigen::Vector3f size(
          0.3F + 3 * unit(random), 0.3F + 2 * unit(random), 0.5F + 4 * unit(random));
      boxes_.push_back({low, low + size});
    }
  }

  float range(const Eigen::Vector3f& from, const Eigen::Vector3f& direction) const {
    const Eigen::Array3f inverse = direction.array().inverse();
    const auto crossing = [&](const Box& box) {
      const Eigen::Array3f a = (box.low - from).array() * inverse;
      const Eigen::Array3f b = (box.high - from).array() * inverse;
      return std::pair(a.min(b).maxCoeff(), a.max(b).minCoeff());
    };
    float nearest = crossing({{-45, -30, 0}, {45, 30, 10}}).second;
    for (const Box& box : boxes_) {
      const auto [enter, leave] = crossing(box);
      if (enter > 0.0F && enter < leave) nearest = std::min(nearest, enter);
    }
    return nearest;
  }

 private:
  std::vector<Box> boxes_;
};

SimulatedScan simulate(const Hall& hall, int number, int scans) {
  std::mt19937 random(static_cast<unsigned>(number));
  std::normal_distribution<float> noise(0.0F, 0.02F);
  SimulatedScan scan;
  const float way = static_cast<float>(number) / static_cast<float>(scans);
  scan.sensor = {-20.0F + 40.0F * way, 0.5F * std::sin(6.0F * way), 1.7F};
  const float heading = 0.3F * std::sin(9.0F * way);
  for (int column = 0; column < 1024; ++column) {
    const float azimuth = heading + 6.2831853F * static_cast<float>(column) / 1024.0F;
    for (int ring = 0; ring < 64; ++ring) {
      const float elevation = 0.3927F * (2.0F * static_cast<float>(ring) / 63.0F - 1.0F);  // 22.5
      const Eigen::Vector3f direction(std::cos(azimuth) * std::cos(elevation),
                                      std::sin(azimuth) * std::cos(elevation),
                                      std::sin(elevation));
      const float range = hall.range(scan.sensor, direction) + noise(random);
      scan.is_hit.push_back(range < max_range ? 1 : 0);
      scan.ends.emplace_back(scan.sensor + std::min(range, max_range) * direction);
    }
  }
  return scan;
}

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

class Engine {
 public:
  virtual ~Engine() = default;
  virtual void add(const SimulatedScan& scan) = 0;
  virtual std::size_t memory() const = 0;

  void timed_add(const SimulatedScan& scan) {
    const double wall = wall_seconds();
    const double cpu = cpu_seconds();
    add(scan);
    cpu_ += cpu_seconds() - cpu;
    wall_ += wall_seconds() - wall;
    ++scans_;
  }
  double cpu() const { return cpu_ / scans_; }
  double wall() const { return wall_ / scans_; }
  int scans() const { return scans_; }

 private:
  double cpu_ = 0.0;
  double wall_ = 0.0;
  int scans_ = 0;
};

class Kissmap : public Engine {
 public:
  Kissmap(double voxel_size, bool thin, int threads)
      : map_({Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(voxel_size), {}}, options(thin)),
        pool_(threads) {}

  void add(const SimulatedScan& scan) override {
    starts_.assign(scan.ends.size(), Eigen::Vector3f::Zero());
    ends_.clear();
    for (const Eigen::Vector3f& end : scan.ends) ends_.emplace_back(end - scan.sensor);
    RayScan rays;
    rays.offset = scan.sensor.cast<double>();
    rays.starts = starts_;
    rays.ends = ends_;
    rays.is_hit = scan.is_hit;
    map_.add(rays, pool_);
  }
  std::size_t memory() const override { return map_.memory_bytes(); }
  const OccupancyMap& map() const { return map_; }

 private:
  static OccupancyOptions options(bool thin) {
    OccupancyOptions options;
    options.one_ray_per_end_voxel = thin;
    return options;
  }
  OccupancyMap map_;
  ThreadPool pool_;
  std::vector<Eigen::Vector3f> starts_, ends_;
};

class Octomap : public Engine {
 public:
  explicit Octomap(double voxel_size) : tree_(voxel_size) {}
  void add(const SimulatedScan& scan) override {
    octomap::Pointcloud cloud;
    for (const Eigen::Vector3f& p : scan.ends) cloud.push_back(p.x(), p.y(), p.z());
    const octomap::point3d sensor(scan.sensor.x(), scan.sensor.y(), scan.sensor.z());
    tree_.insertPointCloud(cloud, sensor, max_range);
  }
  std::size_t memory() const override { return tree_.memoryUsage(); }

 private:
  octomap::OcTree tree_;
};

#ifdef KISSMAP_BONXAI
class BonxaiMap : public Engine {
 public:
  explicit BonxaiMap(double voxel_size) : map_(voxel_size) {}
  void add(const SimulatedScan& scan) override {
    map_.insertPointCloud(scan.ends, scan.sensor, max_range);
  }
  std::size_t memory() const override { return map_.grid().memUsage(); }

 private:
  Bonxai::ProbabilisticMap map_;
};
#endif

void print(const char* name, const Engine& engine) {
  std::printf("%-28s %4d scans  cpu %8.2f ms  wall %8.2f ms  memory %8.2f MB\n",
              name,
              engine.scans(),
              1e3 * engine.cpu(),
              1e3 * engine.wall(),
              1e-6 * static_cast<double>(engine.memory()));
}

/// Ground seen from above, in cells of 1 m: what memory is stated per.
std::size_t square_metres(const OccupancyMap& map) {
  std::map<std::pair<int, int>, int> cells;
  map.for_each_block([&](const OccupancyBlock& block) {
    const Eigen::Vector3d p = voxel_center(map.geometry(), block.first);
    ++cells[{static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))}];
  });
  return cells.size();
}

int run(double voxel_size, int scans, int octomap_scans) {
  const Hall hall;
  Kissmap every(voxel_size, false, 1);
  Kissmap thinned(voxel_size, true, 1);
  Kissmap two_threads(voxel_size, false, 2);
  Octomap octomap(voxel_size);
#ifdef KISSMAP_BONXAI
  BonxaiMap bonxai(voxel_size);
#endif
  for (int i = 0; i < scans; ++i) {
    const SimulatedScan scan = simulate(hall, i, scans);
#ifdef KISSMAP_BONXAI
    bonxai.timed_add(scan);
#endif
    every.timed_add(scan);
    thinned.timed_add(scan);
    two_threads.timed_add(scan);
    if (i < octomap_scans) octomap.timed_add(scan);
  }
  std::printf("voxels of %.3f m, 64 x 1024 rays, %.0f m range\n", voxel_size, max_range);
  print("kissmap, every ray", every);
  print("kissmap, one ray a voxel", thinned);
  print("kissmap, every ray, 2 threads", two_threads);
  if (octomap.scans() > 0) print("octomap, every ray", octomap);
  const auto area = static_cast<double>(square_metres(every.map()));
  std::printf("kissmap: %.0f bytes a square metre of %.0f\n",
              static_cast<double>(every.memory()) / area,
              area);
  std::printf("two threads: wall %.2f of one thread's\n", two_threads.wall() / every.wall());
#ifdef KISSMAP_BONXAI
  print("bonxai, one ray a voxel", bonxai);
  std::printf("every ray: %.2f of bonxai's time; one ray a voxel: %.2f; memory: %.2f\n",
              every.cpu() / bonxai.cpu(),
              thinned.cpu() / bonxai.cpu(),
              static_cast<double>(every.memory()) / static_cast<double>(bonxai.memory()));
#endif
  return 0;
}

}  // namespace
}  // namespace kissmap

int main(int argc, char** argv) {
  const double voxel_size = argc > 1 ? std::atof(argv[1]) : 0.2;
  const int scans = argc > 2 ? std::atoi(argv[2]) : 100;
  return kissmap::run(voxel_size, scans, argc > 3 ? std::atoi(argv[3]) : 3);
}
