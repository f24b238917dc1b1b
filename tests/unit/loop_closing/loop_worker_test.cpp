// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/loop_worker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "kissmap/error.hpp"
#include "support/block_world.hpp"

namespace kissmap {
namespace {

constexpr double voxel_size = 0.5;
constexpr std::uint32_t maps = 8;

/// A way past six places and back to the second and the third.
std::vector<LocalMap> way_past_places() {
  std::vector<LocalMap> way;
  for (std::uint32_t id = 0; id < maps; ++id) {
    LocalMap local_map;
    local_map.id = id;
    local_map.points = block_world(id < 6 ? id : id - 5);
    local_map.surfels = surfels_of(local_map.points, voxel_size);
    local_map.opening = local_map.surfels;
    local_map.opening_scans = 1;
    local_map.path_length = 20.0;
    way.push_back(std::move(local_map));
  }
  return way;
}

class LoopWorkerTest : public testing::Test {
 protected:
  static const std::vector<LocalMap>& way() {
    static const std::vector<LocalMap> made = way_past_places();
    return made;
  }
  static LoopCloser closer(LoopCloser::SurfelSource source) {
    return {LoopClosingOptions{}, voxel_size, std::move(source)};
  }
  static SurfelCloud surfels(std::uint32_t id) { return way().at(id).surfels; }
};

TEST_F(LoopWorkerTest, FindsWhatIsFoundOneByOne) {
  LoopCloser one_by_one = closer(surfels);
  for (const LocalMap& local_map : way()) one_by_one.add(local_map);
  LoopCloser beside = closer(surfels);
  LoopWorker worker(beside);
  for (const LocalMap& local_map : way()) worker.add(local_map);
  worker.finish();
  const auto expected = one_by_one.evidence().closures;
  const auto found = beside.evidence().closures;
  ASSERT_GE(expected.size(), 2U) << "two places are seen again";
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].query_id, expected[i].query_id);
    EXPECT_EQ(found[i].reference_id, expected[i].reference_id);
    EXPECT_EQ(found[i].verdict, expected[i].verdict);
    EXPECT_EQ(found[i].reference_from_query.translation,
              expected[i].reference_from_query.translation);
  }
}

TEST_F(LoopWorkerTest, AFailureReachesTheCallerWhereverItIs) {
  const auto fail = [](std::uint32_t) -> SurfelCloud {
    throw Error(Fault::input, "the disk is gone");
  };
  LoopCloser loops = closer(fail);
  LoopWorker worker(loops);
  const auto feed = [&worker] {
    for (const LocalMap& local_map : way()) worker.add(local_map);
    worker.finish();
  };
  EXPECT_THAT(feed, testing::ThrowsMessage<Error>("the disk is gone"));
  // Nobody takes what comes now: neither may wait for it.
  EXPECT_THAT(feed, testing::ThrowsMessage<Error>("the disk is gone"));
  EXPECT_THAT([&worker] { worker.finish(); }, testing::ThrowsMessage<Error>("the disk is gone"));
}

TEST_F(LoopWorkerTest, LeftEarlyItEndsAndLeavesTheRestUndone) {
  std::atomic<int> asked = 0;
  LoopCloser loops = closer([&asked](std::uint32_t id) {
    ++asked;
    return surfels(id);
  });
  {
    LoopWorker worker(loops);
    worker.add(way()[0]);
    worker.add(way()[1]);
  }
  EXPECT_LE(loops.evidence().map_from_local_map.size(), 2U);
  EXPECT_EQ(asked, 0) << "nothing was seen twice";
}

}  // namespace
}  // namespace kissmap
