// SPDX-License-Identifier: MIT
// ROS 2 bags written with SQLite as rosbag2 does: what is read of them to start late, to count and
// to tell times.
#include "formats/containers/sqlite_bag.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <memory>

#include "formats/sparse_containers.hpp"
#include "formats/support.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::TempDir;
using test::sparse::bytes_read;
using testing::ElementsAre;
using testing::Optional;

constexpr std::uint64_t megabyte = 1 << 20;

struct Row {
  int topic = 1;  ///< 1: /points, 2: /imu
  std::int64_t timestamp = 0;
  std::size_t bytes = 0;
};

class Writer {
 public:
  explicit Writer(const fs::path& path) {
    sqlite3* raw = nullptr;
    EXPECT_EQ(sqlite3_open(path.c_str(), &raw), SQLITE_OK);
    database_.reset(raw);
    run("BEGIN");
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
        "serialization_format TEXT NOT NULL)");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
        "timestamp INTEGER NOT NULL, data BLOB NOT NULL)");
    run("INSERT INTO topics VALUES (1, '/points', 'sensor_msgs/msg/PointCloud2', 'cdr'), "
        "(2, '/imu', 'sensor_msgs/msg/Imu', 'cdr')");
  }
  void run(const std::string& statement) {
    char* error = nullptr;
    sqlite3_exec(database_.get(), statement.c_str(), nullptr, nullptr, &error);
    EXPECT_EQ(error, nullptr) << error;
  }
  void add(const Row& row) {
    run("INSERT INTO messages(topic_id, timestamp, data) VALUES (" + std::to_string(row.topic) +
        ", " + std::to_string(row.timestamp) + ", zeroblob(" + std::to_string(row.bytes) + "))");
  }
  void finish(bool with_index = true) {
    if (with_index) run("CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
    run("COMMIT");
  }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };
  std::unique_ptr<sqlite3, Close> database_;
};

fs::path write(const TempDir& dir, const std::vector<Row>& rows, bool with_index = true) {
  const fs::path path = dir.path() / "bag.db3";
  Writer writer(path);
  for (const Row& row : rows) writer.add(row);
  writer.finish(with_index);
  return path;
}

std::vector<std::int64_t> rest_of(MessageSource& source) {
  std::vector<std::int64_t> times;
  for (Message message; source.next(message);) times.push_back(message.received_ns);
  return times;
}

// A file that ends before the names of its topics has none that could be chosen.
TEST(SqliteBag, CutBeforeItsTopicsIsRefused) {
  const TempDir dir;
  std::vector<Row> rows;
  for (int i = 0; i < 100; ++i) rows.push_back({1, i, 2'000});
  const fs::path path = write(dir, rows);
  fs::resize_file(path, 4'096);  // the page of the tables' descriptions alone
  EXPECT_THAT(test::error_of(Fault::input, [&] { open_sqlite_bag(path, 32 * megabyte); }),
              testing::AllOf(testing::HasSubstr("bag.db3"), testing::HasSubstr("damaged")));
}

// Of two topics, not in the order of their times, and with equal ones.
const std::vector<Row> mixed_rows{
    {1, 50, 9}, {2, 10, 9}, {1, 20, 9}, {1, 20, 9}, {2, 20, 9}, {1, -5, 9}, {1, 70, 9}, {1, 60, 9}};

TEST(SqliteBag, StartsAtAnyMessageAsIfAllBeforeHadBeenRead) {
  for (const bool with_index : {true, false}) {
    const std::vector<std::int64_t> all = with_index
                                              ? std::vector<std::int64_t>{-5, 20, 20, 50, 60, 70}
                                              : std::vector<std::int64_t>{50, 20, 20, -5, 70, 60};
    const TempDir dir;
    const fs::path path = write(dir, mixed_rows, with_index);
    for (std::size_t first = 0; first <= all.size() + 1; ++first) {
      const auto source = open_sqlite_bag(path, 0);
      source->select({0});
      EXPECT_EQ(source->skip(first), std::min(first, all.size()));
      const auto from = static_cast<std::ptrdiff_t>(std::min(first, all.size()));
      EXPECT_EQ(rest_of(*source), std::vector<std::int64_t>(all.begin() + from, all.end()));
    }
    const auto source = open_sqlite_bag(path, 0);
    source->select({0});
    Message message;
    ASSERT_TRUE(source->next(message));
    EXPECT_EQ(source->skip(1), 1U);
    ASSERT_TRUE(source->next(message));
    EXPECT_EQ(message.received_ns, all[2]);
    EXPECT_EQ(source->skip(2), 2U);
    EXPECT_EQ(rest_of(*source), std::vector<std::int64_t>{all[5]});
  }
}

TEST(SqliteBag, ReadsNoDataOfWhatIsSkipped) {
  const TempDir dir;
  std::vector<Row> rows;
  for (int i = 0; i < 100; ++i) rows.push_back({1, i, megabyte});
  const fs::path path = write(dir, rows);
  const std::uint64_t before = bytes_read();
  const auto source = open_sqlite_bag(path, 32 * megabyte);
  source->select({0});
  EXPECT_EQ(source->skip(95), 95U);
  EXPECT_EQ(rest_of(*source), (std::vector<std::int64_t>{95, 96, 97, 98, 99}));
  EXPECT_LT(bytes_read() - before, 7 * megabyte);
}

TEST(SqliteBag, CountsAndTimesOfManySmallMessages) {
  const TempDir dir;
  std::vector<Row> rows;
  for (int i = 0; i < 20'000; ++i) rows.push_back({i % 10 == 0 ? 1 : 2, 100 + i, 500});
  const fs::path path = write(dir, rows);
  const std::uint64_t before = bytes_read();
  const auto source = open_sqlite_bag(path, 32 * megabyte);
  EXPECT_THAT(source->topics()[0].message_count, Optional(2'000U));
  EXPECT_THAT(source->topics()[1].message_count, Optional(18'000U));
  const auto times = source->times(0, 1);
  ASSERT_TRUE(times.has_value()) << "known from counting";
  ASSERT_EQ(times->size(), 2'000U);
  EXPECT_EQ(times->front(), 100);
  EXPECT_EQ(times->back(), 100 + 19'990);
  EXPECT_THAT(source->time_range(), Optional(std::pair<std::int64_t, std::int64_t>(100, 20'099)));
  EXPECT_LT(bytes_read() - before, 16 * megabyte);
}

// 120 MB of clouds and 10,000 messages of another topic between them, without metadata.yaml.
TEST(SqliteBag, InfoOfALargeOneTakesLittleReading) {
  const TempDir dir;
  std::vector<Row> rows;
  for (int i = 0; i < 600; ++i) {
    rows.push_back({1, i * 100'000'000LL, 200'000});
    for (int k = 1; k <= 17; ++k) rows.push_back({2, i * 100'000'000LL + k * 5'000'000, 320});
  }
  const fs::path path = write(dir, rows);
  const std::uint64_t before = bytes_read();
  const auto log = open_log(path);
  const LogInfo about = log->info();
  const auto times = log->known_times();
  log->next();
  EXPECT_LT(bytes_read() - before, test::sparse::most_bytes);
  EXPECT_THAT(about.scan_count, Optional(600U));
  ASSERT_TRUE(about.time_range.has_value());
  EXPECT_EQ(about.time_range->second, 59'985'000'000);
  ASSERT_TRUE(times.has_value());
  EXPECT_EQ(times->size(), 600U);
  EXPECT_EQ(times->back(), 59'900'000'000);
}

TEST(SqliteBag, WhatTakesTooMuchReadingIsNotCounted) {
  const TempDir dir;
  std::vector<Row> rows;
  for (int i = 0; i < 4'000; ++i) rows.push_back({1, i, 3'900});  // a page each
  const fs::path path = write(dir, rows);
  const std::uint64_t before = bytes_read();
  const auto source = open_sqlite_bag(path, 6 * megabyte);
  EXPECT_FALSE(source->topics()[0].message_count.has_value());
  EXPECT_THAT(source->time_range(), Optional(std::pair<std::int64_t, std::int64_t>(0, 3'999)));
  EXPECT_LT(bytes_read() - before, 5 * megabyte) << "given up before the limit";
  source->select({0});
  EXPECT_EQ(rest_of(*source).size(), 4'000U);
}

// As rosbag2 writes it from schema 3 on; the last row counts.
std::string metadata(int points, int imu) {
  const auto topic = [](const std::string& name, int count) {
    return "  - topic_metadata:\n      name: " + name +
           "\n      type: x\n    message_count: " + std::to_string(count) + "\n";
  };
  return "version: 9\nmessage_count: " + std::to_string(points + imu) +
         "\ntopics_with_message_count:\n" + topic("/points", points) + topic("/imu", imu);
}

fs::path write_with_metadata(const TempDir& dir, const std::vector<std::string>& texts) {
  const fs::path path = dir.path() / "bag.db3";
  Writer writer(path);
  writer.run(
      "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, "
      "metadata TEXT NOT NULL)");
  for (const std::string& text : texts) {
    writer.run("INSERT INTO metadata(metadata_version, metadata) VALUES (9, '" + text + "')");
  }
  for (int i = 0; i < 3'000; ++i) writer.add({i % 3 == 0 ? 1 : 2, i, 3'900});
  writer.finish();
  return path;
}

TEST(SqliteBag, CountsAreThoseTheRecorderWroteIntoIt) {
  const TempDir dir;
  const fs::path path = write_with_metadata(dir, {metadata(0, 0), metadata(1'000, 2'000)});
  const std::uint64_t before = bytes_read();
  const auto source = open_sqlite_bag(path, 1);
  EXPECT_THAT(source->topics()[0].message_count, Optional(1'000U));
  EXPECT_THAT(source->topics()[1].message_count, Optional(2'000U));
  EXPECT_LT(bytes_read() - before, megabyte);
}

TEST(SqliteBag, CountsThatDoNotAddUpAreNotBelieved) {
  const TempDir dir;
  for (const std::string& text : {metadata(0, 0), metadata(1'000, 1'999), std::string("][")}) {
    const fs::path path = write_with_metadata(dir, {text});
    EXPECT_THAT(open_sqlite_bag(path, 32 * megabyte)->topics()[0].message_count, Optional(1'000U));
    EXPECT_FALSE(open_sqlite_bag(path, 1)->topics()[0].message_count.has_value());
    fs::remove(path);
  }
}

}  // namespace
}  // namespace kissmap
