// SPDX-License-Identifier: MIT
#include "kissmap/formats/pack.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <limits>

#include "formats/files/xxh3.hpp"
#include "formats/session/pack_log.hpp"
#include "session/example_scans.hpp"
#include "session/example_session.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Pack : public testing::Test {
 protected:
  void write(const std::vector<LogEntry>& entries) const {
    PackWriter writer(path_);
    for (const LogEntry& entry : entries) writer.add(entry);
    writer.finish();
    EXPECT_EQ(writer.bytes(), std::filesystem::file_size(path_));
  }
  std::vector<LogEntry> read() const {
    const auto log = open_packed(path_, {});
    std::vector<LogEntry> entries;
    while (auto entry = log->next()) entries.push_back(std::move(*entry));
    return entries;
  }
  Scan packed(const Scan& scan) const {
    write({entry_of(0, scan)});
    const std::vector<LogEntry> entries = read();
    EXPECT_EQ(entries.size(), 1U);
    Scan result = std::get<Scan>(entries.at(0).content);
    require_consistent(result);
    return result;
  }
  TempDir folder_;
  std::filesystem::path path_ = folder_.path() / "log.kmpack";
};

std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits;
  for (const float value : values) bits.push_back(std::bit_cast<std::uint32_t>(value));
  return bits;
}

void expect_near(const std::vector<Eigen::Vector3f>& points,
                 const std::vector<Eigen::Vector3f>& expected,
                 double half_step) {
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d error =
        (points[i].cast<double>() - expected[i].cast<double>()).cwiseAbs();
    // What comes back is a float, which has no more digits than its spacing.
    const float largest =
        std::max(points[i].cwiseAbs().maxCoeff(), expected[i].cwiseAbs().maxCoeff());
    const double spacing = largest * std::numeric_limits<float>::epsilon();
    ASSERT_LE(error.maxCoeff(), half_step + spacing) << "point " << i;
  }
}

void expect_times_near(const std::vector<float>& times, const std::vector<float>& expected) {
  ASSERT_EQ(times.size(), expected.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(times[i]), static_cast<double>(expected[i]), 1e-9);
  }
}

TEST_F(Pack, KeepsAScanWithinItsResolution) {
  const Scan scan = example_scan(1);
  const Scan result = packed(scan);
  EXPECT_EQ(result.stamp_ns, scan.stamp_ns);
  EXPECT_FALSE(result.stamp_is_index);
  EXPECT_EQ(result.stamp_instant, scan.stamp_instant);
  EXPECT_EQ(result.compensation, scan.compensation);
  EXPECT_EQ(result.time_source, scan.time_source);
  EXPECT_EQ(result.dropped, scan.dropped);
  expect_near(result.points, scan.points, pack_resolution / 2);
  EXPECT_EQ(bits_of(result.intensities), bits_of(scan.intensities));
  expect_times_near(result.time_offsets, scan.time_offsets);
  expect_times_near(result.no_return_time_offsets, scan.no_return_time_offsets);
}

TEST_F(Pack, KeepsNoReturnDirectionsToATenthOfAMilliradian) {
  const Scan scan = example_scan(2);
  const Scan result = packed(scan);
  ASSERT_EQ(result.no_return_directions.size(), scan.no_return_directions.size());
  for (std::size_t i = 0; i < scan.no_return_directions.size(); ++i) {
    const Eigen::Vector3d a = result.no_return_directions[i].cast<double>();
    const Eigen::Vector3d b = scan.no_return_directions[i].cast<double>();
    EXPECT_NEAR(a.norm(), 1.0, 1e-6);
    EXPECT_LE(std::atan2(a.cross(b).norm(), a.dot(b)), 1e-4);
  }
}

TEST_F(Pack, PackingAPackChangesNothingMore) {
  const Scan once = packed(example_scan(3));
  const std::string bytes = read_file(path_);
  const Scan twice = packed(once);
  EXPECT_EQ(twice.points, once.points);
  EXPECT_EQ(bits_of(twice.time_offsets), bits_of(once.time_offsets));
  EXPECT_EQ(bits_of(twice.intensities), bits_of(once.intensities));
  write({entry_of(0, example_scan(3))});
  EXPECT_EQ(read_file(path_), bytes);
}

TEST_F(Pack, KeepsEntriesNamesRefusalsAndOrder) {
  const std::vector<LogEntry> entries = {entry_of(2, example_scan(1, 10)),
                                         {5, "", RefusedScan{"cut off", "a.pcd: byte 9"}},
                                         entry_of(6, example_scan(2, 10)),
                                         entry_of(1'000'000'000'000, example_scan(3, 10))};
  write(entries);
  const std::vector<LogEntry> result = read();
  ASSERT_EQ(result.size(), entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_EQ(result[i].index, entries[i].index);
    EXPECT_EQ(result[i].name, entries[i].name);
    ASSERT_EQ(result[i].content.index(), entries[i].content.index());
  }
  EXPECT_EQ(std::get<RefusedScan>(result[1].content).reason, "cut off");
  EXPECT_EQ(std::get<RefusedScan>(result[1].content).detail, "a.pcd: byte 9");
  EXPECT_EQ(std::get<Scan>(result[3].content).stamp_ns, example_scan(3, 10).stamp_ns);
}

TEST_F(Pack, KeepsScansWithoutPointsTimesOrIntensities) {
  Scan scan;
  scan.stamp_ns = std::numeric_limits<std::int64_t>::min();
  scan.stamp_is_index = true;
  EXPECT_TRUE(packed(scan).points.empty());
  EXPECT_TRUE(packed(scan).stamp_is_index);
  EXPECT_EQ(packed(scan).stamp_ns, scan.stamp_ns);
  scan.points = {{1.0F, 2.0F, 3.0F}};
  const Scan result = packed(scan);
  expect_near(result.points, scan.points, pack_resolution / 2);
  EXPECT_TRUE(result.time_offsets.empty());
  EXPECT_TRUE(result.intensities.empty());
  EXPECT_EQ(result.time_source, TimeSource::none);
}

TEST_F(Pack, KeepsALogWithoutScans) {
  write({});
  EXPECT_TRUE(read().empty());
  EXPECT_EQ(open_packed(path_, {})->info().scan_count, 0U);
}

TEST_F(Pack, KeepsTheFarthestPlausiblePoints) {
  Scan scan;
  const float far = max_plausible_range;
  scan.points = {
      {far, 0, 0}, {0, -far, 0}, {0, 0, far}, {-far, 0, 0}, {5773.502F, 5773.502F, 5773.502F}};
  std::mt19937 random(4);
  std::normal_distribution<float> normal;
  while (scan.points.size() < 2000) {
    Eigen::Vector3f point(normal(random), normal(random), normal(random));
    point *= far / point.norm();
    if (point.norm() <= far) scan.points.push_back(point);
  }
  // One step more than usual, because a point must not be rounded out of the plausible range.
  expect_near(packed(scan).points, scan.points, 1.5 * pack_resolution);
}

TEST_F(Pack, TinyPointsStayReturns) {
  Scan scan;
  scan.points = {{1e-30F, 0, 0}, {0, -1e-4F, 5e-5F}, {1e-4F, 1e-4F, -9e-4F}};
  const Scan result = packed(scan);
  expect_near(result.points, scan.points, pack_resolution);
  EXPECT_GT(result.points[0].x(), 0.0F);
  EXPECT_LT(result.points[1].y(), 0.0F);
  EXPECT_LT(result.points[2].z(), 0.0F);
}

TEST_F(Pack, KeepsEveryKindOfIntensity) {
  Scan scan;
  for (const std::size_t distinct : {1U, 256U, 257U, 65'536U, 65'537U}) {
    scan.points.assign(distinct + 3, Eigen::Vector3f(1, 2, 3));
    scan.intensities.clear();
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      scan.intensities.push_back(0.37F * static_cast<float>(i % distinct) - 50.0F);
    }
    EXPECT_EQ(bits_of(packed(scan).intensities), bits_of(scan.intensities)) << distinct;
  }
  scan.points.assign(4, Eigen::Vector3f(1, 2, 3));
  scan.intensities = {std::nanf("1"), -0.0F, std::numeric_limits<float>::infinity(), 1e-45F};
  EXPECT_EQ(bits_of(packed(scan).intensities), bits_of(scan.intensities));
}

TEST_F(Pack, KeepsTimesOfAnySize) {
  Scan scan;
  scan.time_source = TimeSource::derived;
  scan.points.assign(4, Eigen::Vector3f(1, 2, 3));
  for (const float scale : {1e-9F, 0.1F, 1.05F, 2.0F, 1e6F, 1e38F}) {
    scan.time_offsets = {-scale, 0.0F, scale, 2.0F * scale};
    expect_times_near(packed(scan).time_offsets, scan.time_offsets);
  }
}

TEST_F(Pack, InconsistentScansAreDefectsOfTheCaller) {
  Scan scan;
  scan.points = {{0, 0, 0}};
  PackWriter writer(path_);
  EXPECT_THAT(error_of([&] { writer.add(entry_of(0, scan)); }), StartsWith("internal: "));
  scan.points.clear();
  scan.no_return_directions = {{2, 0, 0}};
  EXPECT_THAT(error_of([&] { writer.add(entry_of(0, scan)); }), StartsWith("internal: "));
  writer.add(entry_of(3, Scan{}));
  EXPECT_THAT(error_of([&] { writer.add(entry_of(3, Scan{})); }), StartsWith("internal: "));
  writer.finish();
  EXPECT_EQ(read().size(), 1U);
}

TEST_F(Pack, SkippingIsReadingWithoutLooking) {
  std::vector<LogEntry> entries;
  for (std::uint32_t i = 0; i < 10; ++i) entries.push_back(entry_of(i, example_scan(i, 50)));
  write(entries);
  const auto log = open_packed(path_, {});
  log->skip(3);
  EXPECT_EQ(log->next()->index, 3U);
  log->skip(5);
  EXPECT_EQ(log->next()->index, 9U);
  EXPECT_FALSE(log->next());
  log->skip(100);
  EXPECT_FALSE(log->next());
}

TEST_F(Pack, TellsWhatItIs) {
  write({entry_of(0, example_scan(1)), entry_of(1, example_scan(2))});
  const auto log = open_packed(path_, {});
  EXPECT_EQ(log->info().format, packed_format_name);
  EXPECT_EQ(log->info().path, path_);
  EXPECT_EQ(log->info().scan_count, 2U);
  const LogFile unread{"log.kmpack", std::filesystem::file_size(path_), ""};
  EXPECT_THAT(log->files(), testing::ElementsAre(unread));
  while (log->next()) {
  }
  EXPECT_EQ(log->files().at(0).xxh3, xxh3_hex(read_file(path_)));
}

TEST_F(Pack, IsFoundAsAFileAndInsideASession) {
  EXPECT_FALSE(probe_packed(path_));
  write({});
  EXPECT_TRUE(probe_packed(path_));
  const auto session = folder_.path() / "session";
  write_session(example_session(), example_surfels(), session);
  EXPECT_FALSE(probe_packed(session));
  std::filesystem::rename(path_, session / pack_file_name);
  EXPECT_TRUE(probe_packed(session));
  EXPECT_EQ(open_packed(session, {})->info().stamp_source, "file names");
}

}  // namespace
}  // namespace kissmap
