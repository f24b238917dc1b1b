// SPDX-License-Identifier: MIT
#include "kissmap/formats/session_replay.hpp"

#include <gmock/gmock.h>

#include "kissmap/formats/registry.hpp"
#include "session/example_session.hpp"
#include "support/small_log.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// A log of 6 scans of which a session has mapped the third and the fifth.
class Replay : public testing::Test {
 protected:
  Replay() {
    write_small_log(log_path_, 6);
    session_.manifest.log.path = log_path_;
    const auto log = open_log(log_path_);
    while (const auto entry = log->next()) {
      if (entry->index != 2 && entry->index != 4) continue;
      SessionScan row;
      row.log_index = entry->index;
      row.mapped.stamp_ns = std::get<Scan>(entry->content).stamp_ns;
      row.mapped.pose_stamp_ns = row.mapped.stamp_ns;
      row.mapped.map_from_lidar.translation = {1.0 * static_cast<double>(entry->index), 2.0, 3.0};
      session_.scans.push_back(row);
    }
    session_.manifest.log.format = log->info().format;
    session_.manifest.log.files = log->files();
  }

  TempDir folder_;
  fs::path log_path_ = folder_.path() / "log";
  Session session_;
};

TEST_F(Replay, GivesTheScansOfTheSessionInTheirPlaces) {
  SessionReplay replay(session_, 0.0, 1000.0);
  EXPECT_EQ(replay.size(), 2U);
  const Gallery gallery;
  for (const int index : {2, 4}) {
    const auto placed = replay.next();
    ASSERT_TRUE(placed);
    EXPECT_EQ(placed->scan_idx, index == 2 ? 0U : 1U);
    EXPECT_EQ(placed->map_from_lidar.translation, Eigen::Vector3d(index, 2.0, 3.0));
    EXPECT_EQ(placed->points, gallery.scan(index).points);
    EXPECT_EQ(placed->intensities.size(), placed->points.size());
  }
  EXPECT_FALSE(replay.next());
  EXPECT_FALSE(replay.next());
}

TEST_F(Replay, GivesEachNthScanAsTheWholeReplayDoes) {
  for (const std::uint64_t every : {1U, 2U, 3U}) {
    SessionReplay whole(session_, 0.0, 1000.0);
    SessionReplay some(session_, 0.0, 1000.0, {}, every);
    for (std::uint64_t i = 0; i < session_.scans.size(); ++i) {
      const auto wanted = whole.next();
      ASSERT_TRUE(wanted);
      if (i % every != 0) continue;
      const auto found = some.next();
      ASSERT_TRUE(found);
      EXPECT_EQ(found->scan_idx, i);
      EXPECT_EQ(found->points, wanted->points);
      EXPECT_EQ(found->pose_stamp_ns, wanted->pose_stamp_ns);
    }
    EXPECT_FALSE(some.next());
  }
}

TEST_F(Replay, FindsALogThatMoved) {
  fs::rename(log_path_, folder_.path() / "elsewhere");
  EXPECT_THAT(error_of([&] { SessionReplay(session_, 0.0, 1000.0); }),
              AllOf(HasSubstr("input"), HasSubstr("--log")));
  SessionReplay replay(session_, 0.0, 1000.0, folder_.path() / "elsewhere");
  EXPECT_TRUE(replay.next());
}

TEST_F(Replay, RefusesALogThatIsNotTheOneMapped) {
  session_.scans[1].mapped.stamp_ns += 1;
  SessionReplay replay(session_, 0.0, 1000.0);
  EXPECT_TRUE(replay.next());
  EXPECT_THAT(error_of([&] { replay.next(); }), HasSubstr("is not the scan"));
}

TEST_F(Replay, RefusesALogThatEndsTooEarly) {
  session_.scans[1].log_index = 17;
  SessionReplay replay(session_, 0.0, 1000.0);
  EXPECT_TRUE(replay.next());
  EXPECT_THAT(error_of([&] { replay.next(); }),
              AllOf(HasSubstr("input"), HasSubstr("ends before scan 17")));
}

}  // namespace
}  // namespace kissmap
