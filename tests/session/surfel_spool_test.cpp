// SPDX-License-Identifier: MIT
#include "kissmap/formats/surfel_spool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "kissmap/error.hpp"
#include "support/file_size_limit.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

SurfelCloud random_surfels(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> coordinate(-50.0F, 50.0F);
  SurfelCloud surfels;
  for (std::size_t i = 0; i < size; ++i) {
    surfels.means.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    surfels.normals.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  }
  return surfels;
}

TEST(SurfelSpoolTest, GivesBackWhatItTookAndLeavesNothing) {
  const TempDir folder;
  {
    SurfelSpool spool(folder.path());
    const std::vector<std::size_t> sizes{1000, 0, 1, 70'000};
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      spool.add(random_surfels(sizes[i], static_cast<unsigned>(i)));
    }
    ASSERT_EQ(spool.size(), sizes.size());
    for (const std::size_t i : {3U, 0U, 1U, 2U, 0U}) {
      const SurfelCloud expected = random_surfels(sizes[i], static_cast<unsigned>(i));
      EXPECT_EQ(spool.read(i).means, expected.means);
      EXPECT_EQ(spool.read(i).normals, expected.normals);
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "not even while it is used";
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SurfelSpoolTest, AFullDiskAndAMissingFolderAreErrors) {
  const TempDir folder;
  EXPECT_THROW(SurfelSpool(folder.path() / "nowhere"), Error);
  SurfelSpool spool(folder.path());
  spool.add(random_surfels(10, 1));
  {
    const FileSizeLimit limit(4096);
    EXPECT_THROW(spool.add(random_surfels(1000, 2)), Error);
  }
  EXPECT_EQ(spool.size(), 1U);
  spool.add(random_surfels(1000, 3));
  EXPECT_EQ(spool.read(1).means, random_surfels(1000, 3).means);
}

}  // namespace
}  // namespace kissmap
