// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/association.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

Trajectory at(std::vector<std::int64_t> stamps_ns) {
  Trajectory trajectory;
  trajectory.poses.resize(stamps_ns.size());
  trajectory.stamps_ns = std::move(stamps_ns);
  return trajectory;
}

// 2^-9 s: double seconds hold its multiples exactly, so that equally near is equally near.
constexpr std::int64_t tick_ns = 1'953'125;

Trajectory random_stamps(std::mt19937& random, std::size_t count, std::int64_t range) {
  std::uniform_int_distribution<std::int64_t> any(0, range);
  std::vector<std::int64_t> stamps;
  while (stamps.size() < count) stamps.push_back(tick_ns * any(random));
  std::ranges::sort(stamps);
  return at(stamps);
}

using Indices = std::vector<std::pair<std::size_t, std::size_t>>;

// Every pair of stamps is looked at, as the rule is stated.
Indices by_brute_force(const Trajectory& reference,
                       const Trajectory& estimate,
                       std::int64_t tolerance,
                       std::int64_t offset) {
  const bool estimate_longer = estimate.size() > reference.size();
  const std::size_t count = std::min(reference.size(), estimate.size());
  Indices pairs;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t best = 0;
    std::int64_t best_apart = std::numeric_limits<std::int64_t>::max();
    for (std::size_t j = 0; j < std::max(reference.size(), estimate.size()); ++j) {
      const std::int64_t r = reference.stamps_ns[estimate_longer ? i : j];
      const std::int64_t e = estimate.stamps_ns[estimate_longer ? j : i] + offset;
      if (std::abs(r - e) >= best_apart) continue;
      best_apart = std::abs(r - e);
      best = j;
    }
    if (best_apart > tolerance) continue;
    pairs.emplace_back(estimate_longer ? i : best, estimate_longer ? best : i);
  }
  return pairs;
}

Indices indices_of(const PosePairs& pairs) {
  Indices result;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    result.emplace_back(pairs.reference_idx[i], pairs.estimate_idx[i]);
  }
  return result;
}

std::string error_of(const Trajectory& reference,
                     const Trajectory& estimate,
                     const AssociationOptions& options = {}) {
  try {
    associate(reference, estimate, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Associate, EqualsBruteForce) {
  std::mt19937 random(7);
  std::size_t paired = 0;
  for (int round = 0; round < 300; ++round) {
    const Trajectory reference = random_stamps(random, 1 + random() % 40, 2000);
    const Trajectory estimate = random_stamps(random, 1 + random() % 40, 2000);
    const auto tolerance = static_cast<std::int64_t>(random() % 50);
    const auto offset = static_cast<std::int64_t>(random() % 200) - 100;
    const Indices expected =
        by_brute_force(reference, estimate, tick_ns * tolerance, tick_ns * offset);
    if (expected.empty()) continue;
    paired += expected.size();
    const PosePairs pairs = associate(reference,
                                      estimate,
                                      {std::ldexp(static_cast<double>(tolerance), -9),
                                       std::ldexp(static_cast<double>(offset), -9)});
    EXPECT_EQ(indices_of(pairs), expected);
    EXPECT_TRUE(pairs.by_stamp);
  }
  EXPECT_GT(paired, 1000U);
}

TEST(Associate, TheToleranceHoldsForStampsSince1970) {
  const std::int64_t start = 1'700'000'000'000'000'000;
  const Trajectory reference = at({start, start + 1'000'000'000});
  EXPECT_EQ(associate(reference, at({start + 9'999'000})).size(), 1U);
  EXPECT_THAT(error_of(reference, at({start + 10'001'000})), testing::HasSubstr("tolerance"));
}

TEST(Associate, NothingInCommonTellsBothSpansAndAnOffset) {
  const Trajectory reference = at({100'000'000'000, 130'000'000'000});
  const std::string message = error_of(reference, at({5'000'000'000, 20'000'000'000}));
  for (const char* part : {"5.000 to 20.000", "100.000 to 130.000", "offset of 95.000"}) {
    EXPECT_THAT(message, testing::HasSubstr(part));
  }
  EXPECT_EQ(associate(reference, at({5'000'000'000}), {0.01, 95.0}).size(), 1U);
}

TEST(Associate, WithoutStampsByIndex) {
  Trajectory plain;
  plain.poses.resize(3);
  const PosePairs pairs = associate(at({1, 2, 3}), plain);
  EXPECT_FALSE(pairs.by_stamp);
  EXPECT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs.stamps_ns, (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_THAT(error_of(at({1, 2}), plain), testing::HasSubstr("3 poses"));
}

TEST(Associate, RefusesWhatIsNoTrajectory) {
  EXPECT_THAT(error_of({}, at({1})), testing::HasSubstr("without poses"));
  EXPECT_THAT(error_of(at({2, 1}), at({1})), testing::HasSubstr("fall"));
  Trajectory nan = at({1});
  nan.poses[0].translation.x() = std::nan("");
  EXPECT_THAT(error_of(at({1}), nan), testing::HasSubstr("not finite"));
  EXPECT_THAT(error_of(at({1}), at({1}), {-1.0, 0.0}), testing::HasSubstr("tolerance"));
  const std::int64_t end = std::numeric_limits<std::int64_t>::max();
  EXPECT_THAT(error_of(at({-end, end}), at({0})), testing::HasSubstr("292 years"));
}

}  // namespace
}  // namespace kissmap
