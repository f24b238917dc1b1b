// SPDX-License-Identifier: MIT
#include "session/example_session.hpp"

#include <fstream>
#include <iterator>
#include <limits>

namespace kissmap {
namespace {

constexpr std::uint64_t scans_per_map = 4;
constexpr std::uint32_t map_count = 3;

LogIdentity example_log() {
  LogIdentity log;
  log.path = "/data/\"quoted\" folder/l\xc3\xb6g";
  log.format = "fake";
  log.stamp_source = "file names";
  log.read_options = {false, "t,\n", "us", 7, "/a \"topic\"", "/a/unit.csv"};
  log.selection = {3, 1000, 2};
  log.files = {{"scans/0.pcd", 0, ""},
               {"scans/1.pcd",
                std::numeric_limits<std::uint64_t>::max(),
                "00112233445566778899aabbccddeeff"}};
  return log;
}

SessionCounts example_counts() {
  SessionCounts counts;
  counts.scans_read = 17;
  counts.scans_used = scans_per_map * map_count;
  counts.scans_refused["cut off"] = {3, {"a.pcd: byte 7", "b.pcd: \t\\ \"x\""}};
  counts.scans_refused["empty"] = {2, {}};
  counts.scans_not_converged = 1;
  counts.points_read = std::numeric_limits<std::uint64_t>::max();
  counts.points_out_of_range = 5;
  counts.points_dropped = {1, 2, 3};
  counts.gaps = {{9, 0.1}, {11, 1e300}};
  return counts;
}

SessionScan example_scan(std::uint64_t i, std::mt19937& random) {
  SessionScan scan;
  scan.log_index = 3 + 2 * i;
  MappedScan& mapped = scan.mapped;
  mapped.stamp_ns = 1'630'577'758'569'489'956 + static_cast<std::int64_t>(i) * 100'000'001;
  mapped.pose_stamp_ns = mapped.stamp_ns + 99'999'999;
  mapped.local_map_id = static_cast<std::uint32_t>(i / scans_per_map);
  mapped.local_map_from_lidar = random_pose(random);
  mapped.deskewed = i % 2 == 0;
  if (mapped.deskewed) mapped.sweep_start_from_sweep_end = random_pose(random);
  mapped.points_read = 100'000 + i;
  mapped.points_in_range = 90'000 + i;
  mapped.iterations = static_cast<std::uint32_t>(i);
  mapped.converged = i % 5 != 0;
  return scan;
}

LocalMap example_local_map(std::uint32_t id, std::mt19937& random) {
  LocalMap map;
  map.id = id;
  if (id > 0) map.map_from_local_map = random_pose(random);
  map.scan_count = scans_per_map;
  map.path_length = 100.0 / 3.0;
  map.displacement = 1e-17;
  map.end = id + 1 == map_count ? LocalMapEnd::end_of_log : LocalMapEnd::split;
  return map;
}

}  // namespace

Rigid3 random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Rigid3 pose;
  for (double& value : pose.translation) value = 1000.0 * unit(random);
  for (int i = 0; i < 4; ++i) pose.rotation.coeffs()[i] = unit(random);
  pose.rotation.normalize();
  return pose;
}

Session example_session() {
  std::mt19937 random(7);
  Session session;
  session.manifest.program_version = "9.8.7";
  session.manifest.log = example_log();
  session.manifest.configuration = "[odometry]\nmax_range = 100.0  # m\n";
  session.manifest.counts = example_counts();
  session.manifest.path_length = 0.1 + 0.2;
  for (std::uint32_t id = 0; id < map_count; ++id) {
    session.local_maps.push_back(example_local_map(id, random));
  }
  for (std::uint64_t i = 0; i < scans_per_map * map_count; ++i) {
    SessionScan scan = example_scan(i, random);
    scan.mapped.map_from_lidar = session.local_maps[scan.mapped.local_map_id].map_from_local_map *
                                 scan.mapped.local_map_from_lidar;
    session.scans.push_back(scan);
  }
  session.scans[0].mapped.stamp_ns = std::numeric_limits<std::int64_t>::min();
  session.scans[1].mapped.pose_stamp_ns = -1;
  return session;
}

std::vector<SurfelCloud> example_surfels() {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> metres(-100.0F, 100.0F);
  std::vector<SurfelCloud> clouds(map_count);
  for (std::size_t id = 0; id < clouds.size(); ++id) {
    for (std::size_t i = 0; i < 40 * id; ++i) {  // the first one is empty
      clouds[id].means.emplace_back(metres(random), metres(random), metres(random));
      clouds[id].normals.push_back(
          Eigen::Vector3f(metres(random), metres(random), metres(random)).normalized());
    }
  }
  return clouds;
}

void write_session(const Session& session,
                   const std::vector<SurfelCloud>& surfels,
                   const std::filesystem::path& path,
                   bool overwrite) {
  SessionWriter writer(path, overwrite);
  auto scan = session.scans.begin();
  for (LocalMap map : session.local_maps) {
    for (; scan != session.scans.end() && scan->mapped.local_map_id == map.id; ++scan) {
      writer.add_scan(*scan);
    }
    map.surfels = surfels.at(map.id);
    writer.add_local_map(map);
  }
  writer.finish(session.manifest);
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  // File systems flush a file to the disk that was emptied and written again, not a new one.
  std::filesystem::remove(path);
  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  stream << bytes;
  EXPECT_TRUE(stream.flush()) << path;
}

}  // namespace kissmap
