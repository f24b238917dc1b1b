// SPDX-License-Identifier: MIT
// Bags and MCAP files of which the head of one chunk is damaged, while their index is whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/recorded_logs.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::read_all;
using test::TempDir;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::size_t clouds = 3;  // each in a chunk of its own

const RecordedClouds& recorded() {
  static const RecordedClouds made = record_clouds(PointLayout::velodyne_22, clouds);
  return made;
}

std::int64_t stamp_of(std::size_t cloud) {
  return static_cast<std::int64_t>(recorded_ns(cloud));
}

/// Changes what stands at the second place of `text` in a file.
void damage_second(const fs::path& file, const std::string& text, const std::string& to) {
  std::ifstream in(file, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(in)), {});
  const std::size_t first = content.find(text);
  const std::size_t second = content.find(text, first + 1);
  ASSERT_NE(second, std::string::npos);
  std::ofstream(file, std::ios::binary) << content.replace(second, to.size(), to);
}

struct Found {
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::string> refusals;
};

Found read(const fs::path& file) {
  Found found;
  for (const LogEntry& entry : read_all(*open_log(file))) {
    if (const auto* scan = std::get_if<Scan>(&entry.content)) {
      found.stamps_ns.push_back(scan->stamp_ns);
    } else {
      found.refusals.push_back(std::get<RefusedScan>(entry.content).detail);
    }
  }
  return found;
}

// The memory of the chunk before is used again for the damaged one.
void expect_first_and_last(const fs::path& file, const std::string& named) {
  const Found found = read(file);
  EXPECT_THAT(found.stamps_ns, ElementsAre(stamp_of(0), stamp_of(2)));
  EXPECT_THAT(found.refusals, ElementsAre(HasSubstr(named)));
}

TEST(DamagedChunks, OfRos1BagsGiveNothingOfTheChunkBefore) {
  const TempDir dir;
  const fs::path file = dir.path() / "log.bag";
  write_ros1_bag(file, recorded());
  EXPECT_THAT(read(file).stamps_ns, ElementsAre(stamp_of(0), stamp_of(1), stamp_of(2)));
  damage_second(file, "compression=none", "compression=nope");
  expect_first_and_last(file, "'nope' is not supported");
}

TEST(DamagedChunks, OfMcapGiveNothingOfTheChunkBefore) {
  const TempDir dir;
  const fs::path file = dir.path() / "log.mcap";
  write_mcap(file, recorded(), {"zstd", true});
  EXPECT_THAT(read(file).stamps_ns, ElementsAre(stamp_of(0), stamp_of(1), stamp_of(2)));
  damage_second(file, std::string("\4\0\0\0zstd", 8), std::string("\4\0\0\0brot", 8));
  expect_first_and_last(file, "'brot' is not supported");
}

// The frame of the second message.
TEST(DamagedChunks, OfMcapWithAWrongCheckSumAreLeftOutAndTold) {
  const TempDir dir;
  const fs::path file = dir.path() / "log.mcap";
  write_mcap(file, recorded(), {"", true});
  damage_second(file, "lidar", "radar");
  expect_first_and_last(file, "its check sum fails");
}

}  // namespace
}  // namespace kissmap
