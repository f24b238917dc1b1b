// SPDX-License-Identifier: MIT
#include "kissmap/mapping/mapper.hpp"

#include <gtest/gtest.h>

#include "kissmap/error.hpp"
#include "support/gallery.hpp"
#include "support/matchers.hpp"

namespace kissmap {
namespace {

Mapper gallery_mapper(ThreadPool& pool, double splitting_distance) {
  LocalMapOptions local_maps;
  local_maps.splitting_distance = splitting_distance;
  return {OdometryOptions{}, local_maps, pool};
}

const MappedScan& used(const MapperStep& step) {
  return std::get<MappedScan>(step.scan);
}

TEST(Mapper, PosesRunOnAcrossLocalMaps) {
  const Gallery gallery;
  ThreadPool pool(1);
  Mapper mapper = gallery_mapper(pool, 10.0);
  std::vector<LocalMap> closed;
  std::uint64_t scans = 0;
  // Map points are 0.22 m apart, so half of that is what point-to-point pairs can promise.
  for (int i = 0; i < 90; ++i) {
    const MapperStep step = mapper.add(gallery.scan(i));
    EXPECT_EQ(used(step).local_map_id, closed.size());
    EXPECT_THAT(used(step).map_from_lidar, PoseNear(Gallery::map_from_lidar(i), 0.1, 0.01)) << i;
    if (step.closed) {
      // The next keypose will be this scan's pose.
      EXPECT_GT(step.closed->displacement, 10.0);
      EXPECT_EQ(step.closed->end, LocalMapEnd::split);
      closed.push_back(*step.closed);
    }
  }
  const auto last = mapper.finish();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->end, LocalMapEnd::end_of_log);
  closed.push_back(*last);
  ASSERT_EQ(closed.size(), 4U);  // 35.6 m in steps of just over 10 m
  for (std::size_t i = 0; i < closed.size(); ++i) {
    EXPECT_EQ(closed[i].id, i);
    EXPECT_GT(closed[i].surfels.size(), 100U);
    EXPECT_GE(closed[i].path_length, closed[i].displacement - 1e-9);
    scans += closed[i].scan_count;
  }
  EXPECT_EQ(scans, 90U);
  EXPECT_THAT(closed[0].map_from_local_map, PoseNear(Rigid3{}, 0.0, 0.0));
}

TEST(Mapper, KeyposeIsThePoseOfTheScanThatClosedTheMapBefore) {
  const Gallery gallery;
  ThreadPool pool(1);
  Mapper mapper = gallery_mapper(pool, 10.0);
  std::optional<Rigid3> keypose;
  for (int i = 0; i < 90; ++i) {
    const MapperStep step = mapper.add(gallery.scan(i));
    if (!step.closed) continue;
    if (keypose) {
      EXPECT_THAT(step.closed->map_from_local_map, PoseNear(*keypose, 1e-12, 1e-12));
    }
    keypose = used(step).map_from_lidar;
  }
  EXPECT_TRUE(keypose);
}

TEST(Mapper, SplittingRuleIsReplaceable) {
  const Gallery gallery;
  ThreadPool pool(1);
  Mapper mapper(OdometryOptions{}, LocalMapOptions{}, pool, [](const LocalMapProgress& progress) {
    return progress.scan_count == 3;
  });
  int closed = 0;
  for (int i = 0; i < 9; ++i) closed += mapper.add(gallery.scan(i)).closed ? 1 : 0;
  EXPECT_EQ(closed, 3);
  EXPECT_FALSE(mapper.finish()) << "no scan belongs to the local map just opened";
}

TEST(Mapper, LeavesOutBadScansAndGoesOn) {
  const Gallery gallery;
  ThreadPool pool(1);
  Mapper mapper = gallery_mapper(pool, 100.0);
  const auto refusal = [&](const Scan& scan) {
    const MapperStep step = mapper.add(scan);
    return std::get_if<ScanRefusal>(&step.scan) ? std::optional(std::get<ScanRefusal>(step.scan))
                                                : std::nullopt;
  };
  Scan nothing;
  EXPECT_EQ(refusal(nothing), ScanRefusal::no_points);  // even as the very first
  EXPECT_EQ(refusal(gallery.scan(1)), std::nullopt);
  EXPECT_EQ(refusal(gallery.scan(1)), ScanRefusal::stamp_repeated);
  EXPECT_EQ(refusal(gallery.scan(0)), ScanRefusal::stamp_out_of_order);
  nothing.stamp_ns = 2 * tenth_second;
  EXPECT_EQ(refusal(nothing), ScanRefusal::no_points);
  Scan far_away = gallery.scan(2);
  for (Eigen::Vector3f& point : far_away.points) point = point.normalized() * 500.0F;
  EXPECT_EQ(refusal(far_away), ScanRefusal::no_points);
  EXPECT_EQ(refusal(gallery.scan(2)), std::nullopt);
  const auto last = mapper.finish();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->scan_count, 2U);
}

TEST(Mapper, ALogOfOneScanMakesOneLocalMap) {
  const Gallery gallery;
  ThreadPool pool(1);
  Mapper mapper = gallery_mapper(pool, 100.0);
  EXPECT_TRUE(used(mapper.add(gallery.scan(0))).converged);
  const auto only = mapper.finish();
  ASSERT_TRUE(only);
  EXPECT_EQ(only->scan_count, 1U);
  EXPECT_EQ(only->path_length, 0.0);
}

TEST(Mapper, PoseHoldsAtTheSweepsEndWhenDeskewed) {
  const Gallery gallery;
  ThreadPool pool(1);
  Mapper mapper = gallery_mapper(pool, 100.0);
  Scan scan = gallery.scan(0);
  scan.time_source = TimeSource::recorded;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    scan.time_offsets.push_back(0.08F * static_cast<float>(i) /
                                static_cast<float>(scan.points.size() - 1));
  }
  const MappedScan deskewed = used(mapper.add(scan));
  EXPECT_TRUE(deskewed.deskewed);
  EXPECT_NEAR(static_cast<double>(deskewed.pose_stamp_ns - deskewed.stamp_ns), 8e7, 10.0);
  const MappedScan as_recorded = used(mapper.add(gallery.scan(1)));
  EXPECT_FALSE(as_recorded.deskewed);
  EXPECT_EQ(as_recorded.pose_stamp_ns, as_recorded.stamp_ns);
}

TEST(Mapper, BitIdenticalForAnyNumberOfThreads) {
  const Gallery gallery;
  const auto poses = [&gallery](int threads) {
    ThreadPool pool(threads);
    Mapper mapper = gallery_mapper(pool, 10.0);
    std::vector<Eigen::Matrix4d> all;
    for (int i = 0; i < 40; ++i)
      all.push_back(used(mapper.add(gallery.scan(i))).map_from_lidar.matrix());
    return all;
  };
  const auto alone = poses(1);
  EXPECT_EQ(poses(2), alone);
  EXPECT_EQ(poses(7), alone);
}

TEST(Options, OutOfRangeValuesAreNamed) {
  OdometryOptions odometry;
  odometry.max_range = std::nan("");
  try {
    require_valid(odometry);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::usage);
    EXPECT_THAT(error.what(), testing::HasSubstr("max_range"));
  }
  LocalMapOptions local_maps;
  local_maps.voxel_size = 0.0;
  EXPECT_THROW(require_valid(local_maps), Error);
}

}  // namespace
}  // namespace kissmap
