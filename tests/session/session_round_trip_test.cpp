// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "kissmap/formats/session.hpp"
#include "session/example_session.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::ElementsAreArray;

// Bit for bit, unlike ==, which takes -0 for 0.
bool same_bits(const Rigid3& a, const Rigid3& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  for (int i = 0; i < 3; ++i) {
    if (!same(a.translation[i], b.translation[i])) return false;
  }
  for (int i = 0; i < 4; ++i) {
    if (!same(a.rotation.coeffs()[i], b.rotation.coeffs()[i])) return false;
  }
  return true;
}

void expect_same(const SessionScan& a, const SessionScan& b) {
  SCOPED_TRACE("log index " + std::to_string(b.log_index));
  EXPECT_EQ(a.log_index, b.log_index);
  EXPECT_EQ(a.mapped.stamp_ns, b.mapped.stamp_ns);
  EXPECT_EQ(a.mapped.pose_stamp_ns, b.mapped.pose_stamp_ns);
  EXPECT_EQ(a.mapped.local_map_id, b.mapped.local_map_id);
  EXPECT_TRUE(same_bits(a.mapped.local_map_from_lidar, b.mapped.local_map_from_lidar));
  EXPECT_TRUE(same_bits(a.mapped.map_from_lidar, b.mapped.map_from_lidar));
  EXPECT_EQ(a.mapped.deskewed, b.mapped.deskewed);
  EXPECT_TRUE(same_bits(a.mapped.sweep_start_from_sweep_end, b.mapped.sweep_start_from_sweep_end));
  EXPECT_EQ(a.mapped.points_read, b.mapped.points_read);
  EXPECT_EQ(a.mapped.points_in_range, b.mapped.points_in_range);
  EXPECT_EQ(a.mapped.iterations, b.mapped.iterations);
  EXPECT_EQ(a.mapped.converged, b.mapped.converged);
}

void expect_same(const LocalMap& a, const LocalMap& b) {
  SCOPED_TRACE("local map " + std::to_string(b.id));
  EXPECT_EQ(a.id, b.id);
  EXPECT_TRUE(same_bits(a.map_from_local_map, b.map_from_local_map));
  EXPECT_EQ(a.scan_count, b.scan_count);
  EXPECT_EQ(a.path_length, b.path_length);
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.end, b.end);
  EXPECT_EQ(a.surfels.size(), 0U);
}

void expect_same(const LogIdentity& a, const LogIdentity& b) {
  EXPECT_EQ(a.path, b.path);
  EXPECT_EQ(a.format, b.format);
  EXPECT_EQ(a.stamp_source, b.stamp_source);
  EXPECT_EQ(a.read_options.kitti_elevation_correction, b.read_options.kitti_elevation_correction);
  EXPECT_EQ(a.read_options.time_field, b.read_options.time_field);
  EXPECT_EQ(a.read_options.time_unit, b.read_options.time_unit);
  EXPECT_EQ(a.read_options.bin_columns, b.read_options.bin_columns);
  EXPECT_EQ(a.read_options.topic, b.read_options.topic);
  EXPECT_EQ(a.selection, b.selection);
  EXPECT_EQ(a.files, b.files);
}

void expect_same(const SessionCounts& a, const SessionCounts& b) {
  EXPECT_EQ(a.scans_read, b.scans_read);
  EXPECT_EQ(a.scans_used, b.scans_used);
  ASSERT_EQ(a.scans_refused.size(), b.scans_refused.size());
  for (const auto& [reason, refusals] : b.scans_refused) {
    EXPECT_EQ(a.scans_refused.at(reason).count, refusals.count);
    EXPECT_EQ(a.scans_refused.at(reason).examples, refusals.examples);
  }
  EXPECT_EQ(a.scans_not_converged, b.scans_not_converged);
  EXPECT_EQ(a.points_read, b.points_read);
  EXPECT_EQ(a.points_out_of_range, b.points_out_of_range);
  EXPECT_EQ(a.points_dropped, b.points_dropped);
  ASSERT_EQ(a.gaps.size(), b.gaps.size());
  for (std::size_t i = 0; i < b.gaps.size(); ++i) {
    EXPECT_EQ(a.gaps[i].log_index, b.gaps[i].log_index);
    EXPECT_EQ(a.gaps[i].seconds, b.gaps[i].seconds);
  }
}

class SessionRoundTrip : public testing::Test {
 protected:
  Session written_and_read(const Session& session) {
    write_session(session, example_surfels(), path_);
    return read_session(path_);
  }
  TempDir folder_;
  std::filesystem::path path_ = folder_.path() / "session";
};

TEST_F(SessionRoundTrip, KeepsEveryBitOfTheTables) {
  const Session expected = example_session();
  const Session read = written_and_read(expected);
  ASSERT_EQ(read.scans.size(), expected.scans.size());
  for (std::size_t i = 0; i < expected.scans.size(); ++i) {
    expect_same(read.scans[i], expected.scans[i]);
  }
  ASSERT_EQ(read.local_maps.size(), expected.local_maps.size());
  for (std::size_t i = 0; i < expected.local_maps.size(); ++i) {
    expect_same(read.local_maps[i], expected.local_maps[i]);
  }
}

TEST_F(SessionRoundTrip, KeepsTheManifest) {
  Session expected = example_session();
  expected.manifest.pack = PackSummary{123, 45, 0.002};
  const Session read = written_and_read(expected);
  EXPECT_EQ(read.path, path_);
  EXPECT_EQ(read.manifest.format_version, session_format_version);
  EXPECT_EQ(read.manifest.program_version, expected.manifest.program_version);
  EXPECT_EQ(read.manifest.configuration, expected.manifest.configuration);
  EXPECT_EQ(read.manifest.path_length, expected.manifest.path_length);
  expect_same(read.manifest.log, expected.manifest.log);
  expect_same(read.manifest.counts, expected.manifest.counts);
  ASSERT_TRUE(read.manifest.pack);
  EXPECT_EQ(read.manifest.pack->bytes, 123U);
  EXPECT_EQ(read.manifest.pack->points, 45U);
  EXPECT_EQ(read.manifest.pack->resolution, 0.002);
}

TEST_F(SessionRoundTrip, KeepsEverySurfel) {
  written_and_read(example_session());
  const std::vector<SurfelCloud> expected = example_surfels();
  for (std::uint32_t id = 0; id < expected.size(); ++id) {
    const SurfelCloud read = read_local_map_surfels(path_, id);
    EXPECT_THAT(read.means, ElementsAreArray(expected[id].means));
    EXPECT_THAT(read.normals, ElementsAreArray(expected[id].normals));
  }
}

TEST_F(SessionRoundTrip, SurvivesOpenSelectionsAndNoPack) {
  Session expected = example_session();
  expected.manifest.log.selection = {};
  const Session read = written_and_read(expected);
  EXPECT_EQ(read.manifest.log.selection, ScanSelection{});
  EXPECT_FALSE(read.manifest.pack);
}

TEST_F(SessionRoundTrip, KeepsASessionWithoutScans) {
  Session empty;
  const Session read = written_and_read(empty);
  EXPECT_TRUE(read.scans.empty());
  EXPECT_TRUE(read.local_maps.empty());
}

TEST_F(SessionRoundTrip, ReplacesBytesThatAreNotUtf8) {
  Session session = example_session();
  session.manifest.log.files = {{"m\xfcller.pcd", 1, ""}};
  const Session read = written_and_read(session);
  EXPECT_EQ(read.manifest.log.files.at(0).name, "m\xef\xbf\xbdller.pcd");
}

TEST_F(SessionRoundTrip, SameInputGivesTheSameBytes) {
  write_session(example_session(), example_surfels(), path_);
  const auto other = folder_.path() / "other";
  write_session(example_session(), example_surfels(), other);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
    if (!entry.is_regular_file()) continue;
    const auto name = entry.path().lexically_relative(path_);
    EXPECT_EQ(read_file(entry.path()), read_file(other / name)) << name;
  }
}

}  // namespace
}  // namespace kissmap
