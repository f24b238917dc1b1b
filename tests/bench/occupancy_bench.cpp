// SPDX-License-Identifier: MIT
// Occupancy engines beside each other, on one core and in one run: a 64 x 1024 sensor driving
// through a hall, 50 m range. Prints seconds a scan, memory, and the ratios.
//   occupancy_bench [voxel size in m, default 0.2] [scans, default 100] [octomap scans, default 3]
#include <octomap/OcTree.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <set>

#include "bench/hall_scans.hpp"
#include "kissmap/occupancy/grazing_margin.hpp"
#include "kissmap/occupancy/occupancy_map.hpp"
#ifdef KISSMAP_BONXAI
#include "bonxai_map/probabilistic_map.hpp"
#endif

namespace kissmap {
namespace {

double cpu_seconds(clockid_t clock = CLOCK_PROCESS_CPUTIME_ID) {
  timespec t{};
  clock_gettime(clock, &t);
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
    const double own = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    add(scan);
    cpu_ += cpu_seconds() - cpu;
    own_cpu_ += cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - own;
    wall_ += wall_seconds() - wall;
    best_wall_ = std::min(best_wall_, wall_seconds() - wall);
    ++scans_;
  }
  double cpu() const { return cpu_ / scans_; }
  double wall() const { return wall_ / scans_; }
  double best_wall() const { return best_wall_; }
  double share_of_other_threads() const { return 1.0 - own_cpu_ / cpu_; }
  int scans() const { return scans_; }

 private:
  double cpu_ = 0.0;
  double own_cpu_ = 0.0;
  double wall_ = 0.0;
  double best_wall_ = std::numeric_limits<double>::infinity();
  int scans_ = 0;
};

class Kissmap : public Engine {
 public:
  Kissmap(double voxel_size, bool thin, int threads)
      : map_({Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(voxel_size), {}}, options(thin)),
        pool_(threads) {}

  void add(const SimulatedScan& scan) override { thinned_ += map_.add(rays(scan), pool_).thinned; }
  std::size_t memory() const override { return map_.memory_bytes(); }
  const OccupancyMap& map() const { return map_; }
  std::uint64_t thinned() const { return thinned_; }

 protected:
  OccupancyMap& target() { return map_; }
  ThreadPool& pool() { return pool_; }
  RayScan rays(const SimulatedScan& scan) {
    starts_.assign(scan.ends.size(), Eigen::Vector3f::Zero());
    ends_.clear();
    for (const Eigen::Vector3f& end : scan.ends) ends_.emplace_back(end - scan.sensor);
    RayScan rays;
    rays.offset = scan.sensor.cast<double>();
    rays.starts = starts_;
    rays.ends = ends_;
    rays.is_hit = scan.is_hit;
    return rays;
  }

 private:
  static OccupancyOptions options(bool thin) {
    OccupancyOptions options;
    options.one_ray_per_end_voxel = thin;
    return options;
  }
  OccupancyMap map_;
  ThreadPool pool_;
  std::vector<Eigen::Vector3f> starts_, ends_;
  std::uint64_t thinned_ = 0;
};

/// As products are made: the floor and walls that rays graze are left whole.
class KissmapWithMargins : public Kissmap {
 public:
  using Kissmap::Kissmap;
  void add(const SimulatedScan& scan) override {
    RayScan all = rays(scan);
    const double before = cpu_seconds();
    const std::vector<float> margins =
        grazing_margins(all, target().geometry().voxel_size, {0.1, 0.03}, pool());
    margins_cpu_ += cpu_seconds() - before;
    all.margins = margins;
    target().add(all, pool());
  }
  double margins_cpu() const { return margins_cpu_ / scans(); }

 private:
  double margins_cpu_ = 0.0;
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

/// Ground below blocks with a known voxel: what memory is stated per.
double square_metres(const OccupancyMap& map) {
  std::set<std::pair<int, int>> columns;
  map.for_each_block([&](const OccupancyBlock& block) {
    columns.insert({block.first.x, block.first.y});
  });
  const Eigen::Vector3d side = occupancy_block_side * map.geometry().voxel_size;
  return static_cast<double>(columns.size()) * side.x() * side.y();
}

int run(double voxel_size, int scans, int octomap_scans) {
  const Hall hall;
  Kissmap every(voxel_size, false, 1);
  Kissmap thinned(voxel_size, true, 1);
  Kissmap two_threads(voxel_size, false, 2);
  KissmapWithMargins products(voxel_size, false, 1);
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
    products.timed_add(scan);
    if (i < octomap_scans) octomap.timed_add(scan);
  }
  std::printf("voxels of %.3f m, 64 x 1024 rays, %.0f m range\n", voxel_size, max_range);
  print("kissmap, every ray", every);
  print("kissmap, one ray a voxel", thinned);
  print("kissmap, every ray, 2 threads", two_threads);
  print("kissmap, as products", products);
  if (octomap.scans() > 0) print("octomap, every ray", octomap);
  const double area = square_metres(every.map());
  std::printf("kissmap: %.0f bytes a square metre of %.0f\n",
              static_cast<double>(every.memory()) / area,
              area);
  std::printf("as products: cpu %.2f ms a scan for grazing margins, %.2f ms for casting\n",
              1e3 * products.margins_cpu(),
              1e3 * (products.cpu() - products.margins_cpu()));
  std::printf("one ray a voxel casts %.0f %% of the rays\n",
              100.0 - static_cast<double>(thinned.thinned()) / scans / 655.36);
  std::printf(
      "two threads: wall %.2f of one thread's, %.2f in the best scan; the second does %.0f %%\n",
      two_threads.wall() / every.wall(),
      two_threads.best_wall() / every.best_wall(),
      100.0 * two_threads.share_of_other_threads());
#ifdef KISSMAP_BONXAI
  print("bonxai, one ray a voxel", bonxai);
  std::printf(
      "every ray: %.2f of bonxai's time; one ray a voxel: %.2f; as products: %.2f; memory: %.2f\n",
      every.cpu() / bonxai.cpu(),
      thinned.cpu() / bonxai.cpu(),
      products.cpu() / bonxai.cpu(),
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
