// SPDX-License-Identifier: MIT
// Plays every stored crash through its fuzz target. A fixed crash stays in tests/fuzz/crashes.
#include <gtest/gtest.h>

#include <functional>
#include <map>

#include "formats/files/input_file.hpp"
#include "formats/support.hpp"

namespace kissmap {

void fuzz_bin(std::span<const std::byte> input);
void fuzz_pcd(std::span<const std::byte> input);
void fuzz_ply(std::span<const std::byte> input);
void fuzz_stamps(std::span<const std::byte> input);

namespace {

TEST(StoredCrashes, StayFixed) {
  const std::map<std::string, std::function<void(std::span<const std::byte>)>> targets = {
      {"bin", fuzz_bin}, {"pcd", fuzz_pcd}, {"ply", fuzz_ply}, {"stamps", fuzz_stamps}};
  for (const auto& [name, target] : targets) {
    std::size_t played = 0;
    for (const auto& file :
         std::filesystem::directory_iterator(std::filesystem::path(KISSMAP_FUZZ_CRASHES) / name)) {
      std::vector<std::byte> bytes;
      read_file(file.path(), bytes);
      EXPECT_NO_THROW(target(bytes)) << file.path();
      ++played;
    }
    EXPECT_GT(played, 0U) << name;
  }
}

}  // namespace
}  // namespace kissmap
