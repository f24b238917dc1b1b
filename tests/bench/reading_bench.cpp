// SPDX-License-Identifier: MIT
// How fast logs are read on one core, through open_log, from files the kernel has cached: bytes of
// the clouds (of packets: of the capture) a second of CPU time, user and system, median of five
// runs. Writes one file at a time into TMPDIR.
//   reading_bench [clouds a log, default 128: 400 MB] [part of a name: only those]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <stdexcept>
#include <vector>

#include "bench/recorded_logs.hpp"
#include "kissmap/formats/registry.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr int runs = 5;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Read {
  std::size_t scans = 0;
  std::size_t points = 0;
};

Read read_all(const fs::path& path) {
  const auto log = open_log(path);
  Read read;
  while (const auto entry = log->next()) {
    if (const auto* refused = std::get_if<RefusedScan>(&entry->content)) {
      throw std::runtime_error(refused->detail);
    }
    ++read.scans;
    read.points += std::get<Scan>(entry->content).points.size();
  }
  return read;
}

struct Measured {
  Read read;
  double seconds = 0.0;
};

Measured measure(const fs::path& path) {
  Measured measured{read_all(path)};  // the first run fills the kernel's cache
  std::vector<double> seconds;
  for (int i = 0; i < runs; ++i) {
    const double before = cpu_seconds();
    read_all(path);
    seconds.push_back(cpu_seconds() - before);
  }
  std::ranges::nth_element(seconds, seconds.begin() + runs / 2);
  measured.seconds = seconds[runs / 2];
  return measured;
}

/// A kind of log of clouds.
struct Kind {
  const char* name;
  const char* file;
  std::function<void(const fs::path&, const RecordedClouds&)> write;
};

const std::vector<Kind>& kinds() {
  const auto mcap = [](std::string_view compression, bool checksums) {
    return [=](const fs::path& path, const RecordedClouds& clouds) {
      write_mcap(path, clouds, {compression, checksums});
    };
  };
  static const std::vector<Kind> all{{"ROS 1 bag", "log.bag", write_ros1_bag},
                                     {"ROS 2 bag, sqlite3", "log.db3", write_ros2_bag},
                                     {"MCAP", "log.mcap", mcap("", false)},
                                     {"MCAP, check sums", "log.mcap", mcap("", true)},
                                     {"MCAP lz4, check sums", "log.mcap", mcap("lz4", true)},
                                     {"MCAP zstd, check sums", "log.mcap", mcap("zstd", true)}};
  return all;
}

bool wanted(const std::string& name, const std::string& part) {
  return name.find(part) != std::string::npos;
}

void print_clouds(const std::string& name, const Measured& measured, std::size_t bytes) {
  std::printf("%-42s %6.2f GB/s %7.1f Mpoints/s %7.2f ms a scan\n",
              name.c_str(),
              1e-9 * static_cast<double>(bytes) / measured.seconds,
              1e-6 * static_cast<double>(measured.read.points) / measured.seconds,
              1e3 * measured.seconds / static_cast<double>(measured.read.scans));
  std::fflush(stdout);
}

void bench_clouds(PointLayout layout, std::size_t count, const std::string& part) {
  RecordedClouds clouds{layout, {}, count};
  const std::string suffix = ", " + std::to_string(clouds.point_step()) + " bytes a point";
  std::vector<Kind> all = kinds();
  if (layout == PointLayout::velodyne_22) all.push_back({"PCD folder", "scans", write_pcd_folder});
  for (const Kind& kind : all) {
    if (!wanted(kind.name + suffix, part)) continue;
    if (clouds.different.empty()) clouds = record_clouds(layout, count);
    const TempDir dir;
    kind.write(dir.path() / kind.file, clouds);
    const Measured measured = measure(dir.path() / kind.file);
    if (measured.read.scans != count) throw std::runtime_error("scans are missing");
    print_clouds(kind.name + suffix, measured, count * clouds.data(0).size());
  }
}

/// A sensor whose packets are captured.
struct Sensor {
  const char* name;
  RecordedPackets (*record)(double seconds);
};
constexpr Sensor sensors[] = {{"Velodyne VLP-16", record_velodyne},
                              {"Hesai PandarXT-32", record_hesai},
                              {"Ouster 64 x 1024", record_ouster}};

void bench_packets(const Sensor& sensor, double seconds) {
  const TempDir dir;
  const RecordedPackets recorded = sensor.record(seconds);
  write_capture(dir.path() / "log.pcap", recorded);
  const Measured measured = measure(dir.path() / "log.pcap");
  const double rate = static_cast<double>(recorded.packets.size()) / measured.seconds;
  std::printf("%-42s %6.2f GB/s %7.1f Mpoints/s %9.0f packets/s, %.0f times what it sends\n",
              sensor.name,
              1e-9 * rate * static_cast<double>(recorded.packets[0].size()),
              1e-6 * static_cast<double>(measured.read.points) / measured.seconds,
              rate,
              rate / recorded.packets_a_second);
  std::fflush(stdout);
}

void run(std::size_t count, const std::string& part) {
  bench_clouds(PointLayout::ouster_48, count, part);
  bench_clouds(PointLayout::velodyne_22, count, part);
  for (const Sensor& sensor : sensors) {
    if (wanted(sensor.name, part)) bench_packets(sensor, 0.5 * static_cast<double>(count));
  }
}

}  // namespace
}  // namespace kissmap

int main(int argc, char** argv) {
  const int clouds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 128;
  kissmap::run(static_cast<std::size_t>(clouds), argc > 2 ? argv[2] : "");
  return 0;
}
