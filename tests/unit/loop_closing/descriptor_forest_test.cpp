// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/descriptor_forest.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace kissmap {
namespace {

std::vector<Descriptor> random_descriptors(std::mt19937_64& random, std::size_t count) {
  std::vector<Descriptor> descriptors(count);
  for (Descriptor& descriptor : descriptors) {
    for (std::uint64_t& word : descriptor) word = random();
  }
  return descriptors;
}

Descriptor with_flipped_bits(Descriptor descriptor, int bits, std::mt19937_64& random) {
  for (int flipped = 0; flipped < bits; ++flipped) {
    const std::uint64_t bit = random() % 256;
    descriptor[bit / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  return descriptor;
}

TEST(DescriptorForest, FindsWhatWasAdded) {
  std::mt19937_64 random(1);
  DescriptorForest forest;
  std::vector<std::vector<Descriptor>> places;
  for (std::uint32_t place = 0; place < 50; ++place) {
    places.push_back(random_descriptors(random, 100));
    forest.add(place, places.back());
  }
  EXPECT_EQ(forest.size(), 5000U);
  for (std::uint32_t place = 0; place < 50; ++place) {
    for (std::uint32_t i = 0; i < 100; i += 9) {
      const auto matches = forest.search(places[place][i], 0, 50);
      ASSERT_EQ(matches.size(), 1U);
      EXPECT_EQ(matches[0].entry.place, place);
      EXPECT_EQ(matches[0].entry.feature, i);
      EXPECT_EQ(matches[0].distance, 0);
      EXPECT_TRUE(forest.search(places[place][i], 0, place).empty()) << "place not asked for";
    }
  }
}

TEST(DescriptorForest, FindsMostOfWhatBruteForceFinds) {
  std::mt19937_64 random(2);
  DescriptorForest forest;
  std::vector<Descriptor> all;
  for (std::uint32_t place = 0; place < 200; ++place) {
    const auto descriptors = random_descriptors(random, 100);
    forest.add(place, descriptors);
    all.insert(all.end(), descriptors.begin(), descriptors.end());
  }
  int near = 0;
  int found = 0;
  for (std::uint32_t i = 0; i < all.size(); i += 7) {
    const Descriptor query = with_flipped_bits(all[i], 25, random);
    for (std::uint32_t place = 0; place < 200; ++place) {
      for (std::uint32_t j = 0; j < 100; ++j) {
        near += hamming_distance(query, all[place * 100 + j]) <= 50 ? 1 : 0;
      }
    }
    for (const auto& match : forest.search(query, 50, 200)) {
      EXPECT_EQ(match.distance,
                hamming_distance(query, all[match.entry.place * 100 + match.entry.feature]));
      ++found;
    }
  }
  EXPECT_GT(near, 2800);
  EXPECT_GT(found, 0.85 * near);
}

TEST(DescriptorForest, OutlivesManyEqualDescriptors) {
  DescriptorForest forest;
  const std::vector<Descriptor> equal(1000, Descriptor{1, 2, 3, 4});
  forest.add(0, equal);
  const auto matches = forest.search(equal[0], 10, 1);
  ASSERT_EQ(matches.size(), 1U) << "the nearest one of each place";
  EXPECT_EQ(matches[0].distance, 0);
  EXPECT_TRUE(DescriptorForest().search(equal[0], 256, 10).empty());
}

}  // namespace
}  // namespace kissmap
