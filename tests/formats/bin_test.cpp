// SPDX-License-Identifier: MIT
#include "formats/clouds/bin.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

using test::Bytes;
using test::bytes_of;

std::string rows(int count, int columns) {
  Bytes bytes;
  for (int r = 0; r < count; ++r) {
    for (int c = 0; c < columns; ++c) {
      bytes.add<float>(c == 5 ? 0.01F * static_cast<float>(r) - 0.05F
                              : static_cast<float>(10 * r + c + 1));
    }
  }
  return bytes.text();
}

TEST(Bin, ReadsRowsOfAnyWidth) {
  for (const int columns : {3, 4, 5, 6, 7, 64}) {
    const std::string file = rows(11, columns);
    const Scan scan = ScanDecoder({}).decode(read_bin(bytes_of(file), columns), 0);
    require_consistent(scan);
    ASSERT_EQ(scan.points.size(), 11U) << columns;
    EXPECT_EQ(scan.points[10], Eigen::Vector3f(101, 102, 103));
    EXPECT_EQ(scan.intensities.size(), columns > 3 ? 11U : 0U);
    EXPECT_EQ(scan.time_offsets.size(), columns == 6 ? 11U : 0U);
  }
}

// Boreas: times around the middle of the sweep (trap 11).
TEST(Bin, SixColumnsHaveTimesAroundTheMiddle) {
  const std::string file = rows(11, 6);
  const Scan scan = ScanDecoder({}).decode(read_bin(bytes_of(file), 6), 0);
  EXPECT_NEAR(scan.time_offsets.front(), -0.05, 1e-7);
  EXPECT_NEAR(scan.time_offsets.back(), 0.05, 1e-7);
  EXPECT_EQ(scan.stamp_instant, StampInstant::sweep_middle);
}

TEST(Bin, RefusesSizesThatAreNoMultipleOfARow) {
  const std::string file = rows(3, 4);
  try {
    read_bin(bytes_of(file).first(47), 4);
    FAIL();
  } catch (const Refusal& refusal) {
    EXPECT_STREQ(refusal.reason(), refusal_reason::wrong_size);
    EXPECT_THAT(refusal.what(), testing::HasSubstr("47 bytes are no multiple of 16"));
  }
}

std::string inferred(const std::vector<std::uint64_t>& sizes, const std::string& sample) {
  const auto result = infer_bin_columns(sizes, bytes_of(sample));
  if (const int* columns = std::get_if<int>(&result)) return std::to_string(*columns);
  return std::get<std::string>(result);
}

TEST(BinColumns, FollowFromSizesThatOnlyOneWidthDivides) {
  EXPECT_EQ(inferred({16 * 7, 16 * 11}, rows(7, 4)), "4");
  EXPECT_EQ(inferred({20 * 7, 20 * 11}, rows(7, 5)), "5");
  EXPECT_EQ(inferred({24 * 7, 24 * 11}, rows(7, 6)), "6");
  EXPECT_EQ(inferred({16 * 5, 16 * 3, 16 * 7}, rows(5, 4)), "4");  // 80 alone would fit 5, too
}

TEST(BinColumns, AreNotGuessed) {
  using testing::HasSubstr;
  EXPECT_THAT(inferred({80}, rows(5, 4)), HasSubstr("several widths"));
  EXPECT_THAT(inferred({16 * 7, 16 * 11 + 1}, rows(7, 4)), HasSubstr("no multiples"));
  EXPECT_THAT(inferred({28}, rows(1, 7)), HasSubstr("no multiples"));
  EXPECT_THAT(inferred({}, ""), HasSubstr("several widths"));
  Bytes far;
  far.add<float>(1).add<float>(-1000.5F).add<float>(1).add<float>(1);
  EXPECT_THAT(inferred({16}, far.text()), HasSubstr("beyond 1 km"));
  EXPECT_THAT(inferred({16}, std::string(16, '\xff')), HasSubstr("not finite"));
}

}  // namespace
}  // namespace kissmap
