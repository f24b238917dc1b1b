// SPDX-License-Identifier: MIT
// Rays of which nothing came back in the maps of the real binary, from a capture made by hand: a
// VLP-16 stands 1 m above a floor. In front of it all shots meet something 4 m away; behind it the
// lowest laser sees the floor and the others see nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <fstream>

#include "formats/capture_bytes.hpp"
#include "formats/velodyne_packets.hpp"
#include "products/true_session.hpp"
#include "support/map_loader_rules.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::VelodynePacket;
using testing::HasSubstr;

constexpr unsigned vlp_16 = 0x22;
constexpr unsigned strongest = 0x37;
constexpr std::size_t packets = 150;   // two turns of 900 blocks
constexpr unsigned wall = 2000;        // 4 m in steps of 2 mm
constexpr unsigned floor_seen = 1932;  // 1 m / sin 15 degrees

std::string packet_of(std::size_t number) {
  VelodynePacket packet(vlp_16, strongest, 800'000'000 + static_cast<std::uint32_t>(1327 * number));
  for (std::size_t block = 0; block < VelodynePacket::blocks; ++block) {
    const std::size_t azimuth = 40 * (VelodynePacket::blocks * number + block) % 36000;
    const bool behind = azimuth >= 9000 && azimuth < 27000;
    packet.azimuth(block, static_cast<long>(azimuth));
    for (std::size_t shot = 0; shot < VelodynePacket::shots; ++shot) {
      const bool lowest = shot % 16 == 0;
      packet.shot(block, shot, lowest ? floor_seen : behind ? 0 : wall, 9);
    }
  }
  const std::vector<std::byte> bytes = packet.bytes();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

class NoReturns : public testing::Test {
 protected:
  void SetUp() override {
    std::vector<std::string> frames;
    for (std::size_t i = 0; i < packets; ++i) {
      frames.push_back(test::ethernet(test::ipv4(test::udp(2368, packet_of(i)))));
    }
    std::ofstream(path("log.pcap"), std::ios::binary) << test::pcap(frames);
    make_session(path("log.pcap"), path("session"));
  }

  static void make_session(const fs::path& log, const fs::path& session) {
    write_true_session(log, session, [](const Scan& scan) {
      MappedScan mapped;
      mapped.stamp_ns = scan.stamp_ns;
      mapped.pose_stamp_ns = scan.stamp_ns + 100'000'000;
      mapped.deskewed = scan.time_source != TimeSource::none;
      return mapped;
    });
  }

  fs::path path(const std::string& name) const { return folder_.path() / name; }

  std::string exported(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), KISSMAP_BINARY);
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  }

  TempDir folder_;
};

enum class Seen { unknown, free, occupied };

Seen seen_at(const fs::path& file, double x, double y, double z) {
  octomap::OcTree tree(file.string());
  const octomap::OcTreeNode* node = tree.search(x, y, z);
  if (node == nullptr) return Seen::unknown;
  return tree.isNodeOccupied(node) ? Seen::occupied : Seen::free;
}

// The ray straight back, 3 degrees up, is 0.26 m up after 5 m and 0.37 m after 7 m.
TEST_F(NoReturns, ClearVoxelsAsFarAsIsSaid) {
  const std::vector<std::string> common{"--resolution", "0.2", "--frame", "map"};
  const auto voxels = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> arguments{"export-voxels", path("session"), "-o", path(name)};
    arguments.insert(arguments.end(), common.begin(), common.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return exported(arguments);
  };
  voxels("silent.bt", {});
  EXPECT_EQ(seen_at(path("silent.bt"), -5.1, 0.1, 0.3), Seen::unknown);
  EXPECT_EQ(seen_at(path("silent.bt"), 2.1, 0.1, 0.1), Seen::free);
  // 900 blocks look back, 30 of 32 shots of each see nothing.
  EXPECT_THAT(voxels("clear.bt", {"--no-return-range", "6"}),
              HasSubstr("no return   27,000 rays, free up to 6 m"));
  EXPECT_EQ(seen_at(path("clear.bt"), -5.1, 0.1, 0.3), Seen::free);
  EXPECT_EQ(seen_at(path("clear.bt"), -7.1, 0.1, 0.3), Seen::unknown);
  EXPECT_EQ(seen_at(path("clear.bt"), 5.1, 0.1, 0.3), Seen::unknown) << "behind the wall";
}

/// -1 unknown, 0 free, 100 occupied, and unknown beside the map.
int cell_at(const fs::path& yaml, double x, double y) {
  const LoadedMap map = load_map(yaml, MapLoader::nav2);
  const auto column = static_cast<int>(std::floor((x - map.origin[0]) / map.resolution));
  const auto row = static_cast<int>(std::floor((y - map.origin[1]) / map.resolution));
  if (column < 0 || row < 0 || column >= map.width || row >= map.height) return -1;
  return map.data.at(static_cast<std::size_t>(row * map.width + column));
}

TEST_F(NoReturns, ClearCellsAsFarAsIsSaid) {
  const std::vector<std::string> common{
      "export-grid", path("session"), "--resolution", "0.1", "--z-reference", "map", "-o"};
  const auto grid = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> arguments = common;
    arguments.push_back(path(name));
    arguments.insert(arguments.end(), more.begin(), more.end());
    exported(arguments);
    return path(name + ".yaml");
  };
  const fs::path silent = grid("silent", {});
  EXPECT_EQ(cell_at(silent, -5.05, 0.05), -1);
  EXPECT_EQ(cell_at(silent, 2.05, 0.05), 0);
  const fs::path clear = grid("clear", {"--no-return-range", "6"});
  EXPECT_EQ(cell_at(clear, -5.05, 0.05), 0);
  EXPECT_EQ(cell_at(clear, -7.05, 0.05), -1);
  EXPECT_EQ(cell_at(clear, 3.95, 0.05), 100) << "the wall stays";
  EXPECT_EQ(cell_at(clear, 5.05, 0.05), -1) << "and so does what is behind it";
}

TEST_F(NoReturns, AreMissedWhereTheLogTellsOfNone) {
  fs::create_directories(path("clouds"));
  std::ofstream(path("clouds") / "0.xyz") << "4 0 0\n4 1 0\n4 0 1\n";
  make_session(path("clouds"), path("of_clouds"));
  const std::string said = exported(
      {"export-voxels", path("of_clouds"), "-o", path("clouds.bt"), "--no-return-range", "6"});
  EXPECT_THAT(said, HasSubstr("tells of no ray without a return"));
}

}  // namespace
}  // namespace kissmap
