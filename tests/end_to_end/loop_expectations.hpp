// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "support/loop_tour.hpp"

namespace kissmap {

/// Number of seeds to test: 1, or KISSMAP_SEEDS.
inline std::uint64_t seeds() {
  const char* text = std::getenv("KISSMAP_SEEDS");
  return text == nullptr ? 1 : std::strtoull(text, nullptr, 10);
}

/// Every accepted closure is where the truth puts it.
inline void expect_true_closures(const LoopTour& tour, double metres) {
  for (const Closure& closure : tour.accepted()) {
    EXPECT_LT(tour.off_by(closure), metres) << closure.query_id << " to " << closure.reference_id;
    EXPECT_LT(tour.turned_by(closure), 0.1) << closure.query_id << " to " << closure.reference_id;
  }
}

/// No pair of local maps is closed twice.
inline void expect_each_pair_once(const LoopTour& tour) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Closure& closure : tour.accepted()) {
    pairs.emplace_back(closure.query_id, closure.reference_id);
  }
  std::ranges::sort(pairs);
  EXPECT_EQ(std::ranges::adjacent_find(pairs), pairs.end());
}

/// At least nine of ten revisits are found.
inline void expect_most_found(const LoopTour& tour, const std::vector<std::uint32_t>& revisits) {
  EXPECT_GE(10 * tour.found(revisits), 9 * revisits.size());
}

}  // namespace kissmap
