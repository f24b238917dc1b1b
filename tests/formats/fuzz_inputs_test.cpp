// SPDX-License-Identifier: MIT
// Plays every stored input through its fuzz target: seeds, and crashes that were fixed.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "formats/allocation_meter.hpp"
#include "formats/files/input_file.hpp"
#include "formats/support.hpp"
#include "fuzz/container.hpp"
#include "fuzz/target.hpp"

namespace kissmap {

void fuzz_bin(std::span<const std::byte> input);
void fuzz_calibration(std::span<const std::byte> input);
void fuzz_capture(std::span<const std::byte> input);
void fuzz_capture_log(std::span<const std::byte> input);
void fuzz_cloud_message(std::span<const std::byte> input);
void fuzz_dataset(std::span<const std::byte> input);
void fuzz_edits(std::span<const std::byte> input);
void fuzz_g2o(std::span<const std::byte> input);
void fuzz_lvx(std::span<const std::byte> input);
void fuzz_mcap(std::span<const std::byte> input);
void fuzz_other_clouds(std::span<const std::byte> input);
void fuzz_pack(std::span<const std::byte> input);
void fuzz_packed_bag(std::span<const std::byte> input);
void fuzz_packets(std::span<const std::byte> input);
void fuzz_pcd(std::span<const std::byte> input);
void fuzz_ply(std::span<const std::byte> input);
void fuzz_ros2_folder(std::span<const std::byte> input);
void fuzz_rosbag(std::span<const std::byte> input);
void fuzz_sqlite_bag(std::span<const std::byte> input);
void fuzz_stamp_tables(std::span<const std::byte> input);
void fuzz_stamps(std::span<const std::byte> input);
void fuzz_trajectory(std::span<const std::byte> input);

namespace {

// A target that cannot open its files finds nothing, forever.
const std::set<std::string> containers{"mcap", "packed_bag", "ros2_folder", "rosbag", "sqlite_bag"};

TEST(FuzzInputs, AreReadOrRefused) {
  const std::map<std::string, std::function<void(std::span<const std::byte>)>> targets = {
      {"bin", fuzz_bin},
      {"calibration", fuzz_calibration},
      {"capture", fuzz_capture},
      {"capture_log", fuzz_capture_log},
      {"cloud_message", fuzz_cloud_message},
      {"dataset", fuzz_dataset},
      {"edits", fuzz_edits},
      {"g2o", fuzz_g2o},
      {"lvx", fuzz_lvx},
      {"mcap", fuzz_mcap},
      {"other_clouds", fuzz_other_clouds},
      {"pack", fuzz_pack},
      {"packed_bag", fuzz_packed_bag},
      {"packets", fuzz_packets},
      {"pcd", fuzz_pcd},
      {"ply", fuzz_ply},
      {"ros2_folder", fuzz_ros2_folder},
      {"rosbag", fuzz_rosbag},
      {"sqlite_bag", fuzz_sqlite_bag},
      {"stamp_tables", fuzz_stamp_tables},
      {"stamps", fuzz_stamps},
      {"trajectory", fuzz_trajectory}};
  for (const auto& [name, target] : targets) {
    std::size_t played = 0;
    const std::uint64_t messages = fuzz_messages;
    for (const auto& file :
         std::filesystem::directory_iterator(std::filesystem::path(KISSMAP_FUZZ_INPUTS) / name)) {
      std::vector<std::byte> bytes;
      read_file(file.path(), bytes);
      test::forget_allocations();
      EXPECT_NO_THROW(target(bytes)) << file.path();
      EXPECT_LE(test::largest_allocation(), (fuzz_mebibytes << 20U) + fuzz_multiple * bytes.size())
          << file.path();
      ++played;
    }
    EXPECT_GT(played, 0U) << name;
    if (containers.contains(name)) {
      EXPECT_GT(fuzz_messages, messages) << name;
    }
  }
}

}  // namespace
}  // namespace kissmap
