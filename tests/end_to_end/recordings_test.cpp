// SPDX-License-Identifier: MIT
// The real binary on real recordings, with the default configuration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/program.hpp"
#include "support/temp_dir.hpp"
#include "support/trajectory_error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Recordings : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("KISSMAP_TEST_DATA");
    if (folder == nullptr) GTEST_SKIP() << "KISSMAP_TEST_DATA does not say where recordings are";
    data_ = folder;
  }

  /// Maps a recording and returns the poses; `out` is what the program printed.
  Positions map(const std::string& log, std::vector<std::string> more = {}) {
    std::vector<std::string> command{KISSMAP_BINARY, "run", data_ / log, "-o", session()};
    command.insert(command.end(), more.begin(), more.end());
    const ProgramResult result = run_program(command);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    out_ = result.out;
    return read_tum_positions(session() / "trajectory.tum");
  }

  fs::path session() const { return temp_.path() / "session"; }
  fs::path data_;
  std::string out_;

 private:
  TempDir temp_;
};

TEST_F(Recordings, HallIsTrackedWithinThreeCentimetres) {
  const Positions estimate = map("hall_ouster");
  const TrajectoryError error =
      trajectory_error(estimate, read_tum_positions(data_ / "hall_ouster/reference.tum"));
  EXPECT_EQ(error.matched, 60U);
  EXPECT_LE(error.ate, 0.03);
  RecordProperty("ate_m", std::to_string(error.ate));
}

TEST_F(Recordings, KittiDriveIsTrackedAtADrivingSpeed) {
  const Positions estimate = map("kitti_drive");
  ASSERT_EQ(estimate.size(), 22U);
  // A straight drive at an even speed: 17 m, as its description says, in 21 like steps. The first
  // ones, against a map of one or two scans, are a decimetre off, as they are in the published
  // program (0.70 to 0.87 m).
  EXPECT_NEAR(length_of(estimate), 17.0, 0.5);
  for (auto it = std::next(estimate.begin()); it != estimate.end(); ++it) {
    EXPECT_NEAR((it->second - std::prev(it)->second).norm(), 17.0 / 21.0, 0.15);
  }
  EXPECT_THAT(out_, HasSubstr("stamps from index"));
}

TEST_F(Recordings, CampusWithANarrowViewIsMappedToItsEnd) {
  // Its accuracy is the subject of later work; here every scan must be used and every pose finite.
  const Positions estimate = map("campus_avia_loop");
  EXPECT_EQ(estimate.size(), 314U);
  for (const auto& [stamp, position] : estimate) EXPECT_TRUE(position.allFinite()) << stamp;
  EXPECT_THAT(out_, HasSubstr("gap"));
}

TEST_F(Recordings, APackedRecordingGivesTheSameMap) {
  const Positions from_log = map("hall_ouster", {"--pack", "--last", "19"});
  const fs::path packed = session().parent_path() / "packed";
  fs::rename(session(), packed);
  const ProgramResult result =
      run_program({KISSMAP_BINARY, "run", packed.string(), "-o", session().string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Positions from_pack = read_tum_positions(session() / "trajectory.tum");
  ASSERT_EQ(from_pack.size(), from_log.size());
  // Points moved by up to 1 mm an axis; the poses may by as much again.
  for (const auto& [stamp, position] : from_log) {
    EXPECT_LT((from_pack.at(stamp) - position).norm(), 0.01);
  }
}

}  // namespace
}  // namespace kissmap
