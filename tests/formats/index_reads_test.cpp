// SPDX-License-Identifier: MIT
// Containers of 20 GB that are holes but for their first chunk and their index: what is told of
// them comes from the index, and so do gaps. Where the place of the index is wrong, it takes no
// more memory than an index.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/allocation_meter.hpp"
#include "formats/sparse_containers.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
namespace sparse = test::sparse;
using test::TempDir;
using testing::ElementsAre;
using testing::Optional;

using Write = fs::path (*)(const TempDir&, sparse::IndexPlace);

class LargeContainers : public testing::TestWithParam<Write> {};

TEST_P(LargeContainers, TellFromTheirIndexAlone) {
  const TempDir dir;
  const fs::path path = GetParam()(dir, sparse::IndexPlace::true_one);
  ASSERT_GT(fs::file_size(path), 20'000'000'000U);
  const std::uint64_t before = sparse::bytes_read();
  const auto log = open_log(path);
  const LogInfo info = log->info();
  const auto times = log->known_times();
  EXPECT_LT(sparse::bytes_read() - before, sparse::most_bytes);
  EXPECT_THAT(info.scan_count, Optional(sparse::chunks));
  ASSERT_EQ(info.topics.size(), 1U);
  EXPECT_EQ(info.topics[0].name, "/points");
  ASSERT_TRUE(info.time_range.has_value());
  EXPECT_EQ((info.time_range->second - info.time_range->first) / 1'000'000'000,
            sparse::chunks - 1 + 60);
  ASSERT_TRUE(times.has_value());
  ASSERT_EQ(times->size(), sparse::chunks);
  for (std::size_t i = 0; i < sparse::chunks; ++i) {
    ASSERT_EQ((*times)[i], static_cast<std::int64_t>(sparse::stamp_s(i)) * 1'000'000'000) << i;
  }
  const auto first = log->next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(test::scan_of(*first).points.at(0), Eigen::Vector3f(1, 2, 3));
  EXPECT_LT(sparse::bytes_read() - before, sparse::most_bytes);
}

// What stands there is chunks, which are no index.
TEST_P(LargeContainers, WithAWrongPlaceOfTheIndexAreLookedThroughInBoundedMemory) {
  for (const auto place : {sparse::IndexPlace::first_record, sparse::IndexPlace::hole}) {
    const TempDir dir;
    const fs::path path = GetParam()(dir, place);
    test::forget_allocations();
    const std::uint64_t before = sparse::bytes_read();
    const auto log = open_log(path);
    const auto first = log->next();
    ASSERT_TRUE(first.has_value());
    EXPECT_EQ(test::scan_of(*first).points.at(0), Eigen::Vector3f(1, 2, 3));
    EXPECT_LT(sparse::bytes_read() - before, sparse::most_bytes);
    EXPECT_LT(test::largest_allocation(), 2 * sparse::chunk_bytes);
    EXPECT_FALSE(log->info().notes.empty());
    EXPECT_FALSE(log->info().scan_count == sparse::chunks) << "its index was not found";
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, LargeContainers, testing::Values(sparse::mcap, sparse::bag));

TEST(KnownTimes, OfAFolderAreItsStamps) {
  const TempDir dir;
  for (const char* name :
       {"1700000000000000000.xyz", "1700000000100000000.xyz", "1700000007000000000.xyz"})
    dir.write(name, "1 2 3\n4 5 6\n");
  const auto log = open_log(dir.path());
  EXPECT_THAT(
      log->known_times(),
      Optional(ElementsAre(
          1'700'000'000'000'000'000, 1'700'000'000'100'000'000, 1'700'000'007'000'000'000)));
}

TEST(KnownTimes, OfAFolderWithoutStampsAreNot) {
  const TempDir dir;
  for (const char* name : {"1.xyz", "2.xyz"}) dir.write(name, "1 2 3\n4 5 6\n");
  EXPECT_FALSE(open_log(dir.path())->known_times().has_value());
}

}  // namespace
}  // namespace kissmap
