// SPDX-License-Identifier: MIT
// Recordings turned into bags by other programs: ROS 1 by rosbag, ROS 2 by Fast-CDR and SQLite.
// Mapped by the real binary, they give what the folders they were made of give.
#include <fastcdr/Cdr.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "kissmap/formats/registry.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

constexpr std::int64_t ns_per_s = 1'000'000'000;

/// sensor_msgs/PointCloud2 with x y z intensity, as eProsima's library serialises its members.
std::string point_cloud2(const Scan& scan, Cdr::Endianness order) {
  std::vector<std::uint8_t> data;
  const auto put = [&data](float value) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    data.insert(data.end(), bytes, bytes + sizeof(value));
  };
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    for (const float coordinate : scan.points[i]) put(coordinate);
    put(scan.intensities[i]);
  }
  FastBuffer buffer;
  Cdr cdr(buffer, order, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  cdr << static_cast<std::int32_t>(scan.stamp_ns / ns_per_s);
  cdr << static_cast<std::uint32_t>(scan.stamp_ns % ns_per_s) << std::string("lidar");
  cdr << std::uint32_t{1} << static_cast<std::uint32_t>(scan.points.size()) << std::uint32_t{4};
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "intensity"}) {
    cdr << std::string(name) << offset << std::uint8_t{7} << std::uint32_t{1};
    offset += 4;
  }
  cdr << false << std::uint32_t{16} << static_cast<std::uint32_t>(data.size()) << data << true;
  return {buffer.getBuffer(), cdr.getSerializedDataLength()};
}

void execute(sqlite3* database, const std::string& statement) {
  if (sqlite3_exec(database, statement.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    throw std::runtime_error(statement + ": " + sqlite3_errmsg(database));
  }
}

/// Tables as rosbag2_storage_sqlite3 makes them, by version of their schema.
void make_tables(sqlite3* database, int version) {
  std::string columns =
      "id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL";
  std::string values = "1, '/points', 'sensor_msgs/msg/PointCloud2', 'cdr'";
  if (version >= 2) {
    columns += ", offered_qos_profiles TEXT NOT NULL";
    values += ", ''";
  }
  if (version >= 4) {
    columns += ", type_description_hash TEXT NOT NULL";
    values += ", ''";
  }
  execute(database, "CREATE TABLE topics(" + columns + ")");
  execute(database,
          "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
          "INTEGER NOT NULL, data BLOB NOT NULL)");
  execute(database, "CREATE INDEX timestamp_idx ON messages (timestamp ASC)");
  if (version >= 3) {
    execute(database,
            "CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)");
    execute(database,
            "CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT "
            "NULL, metadata TEXT NOT NULL)");
  }
  execute(database, "INSERT INTO topics VALUES(" + values + ")");
  execute(database,
          "INSERT INTO topics VALUES(2" + values.substr(1, values.find("', '", 4) - 1) +
              "', 'sensor_msgs/msg/Imu'" + values.substr(values.find(", 'cdr'")) + ")");
}

/// Every scan of a log, in reversed order where ids do not tell the time.
void write_sqlite_bag(const fs::path& log,
                      const fs::path& file,
                      int version,
                      Cdr::Endianness order) {
  sqlite3* database = nullptr;
  if (sqlite3_open(file.c_str(), &database) != SQLITE_OK) throw std::runtime_error("no database");
  make_tables(database, version);
  execute(database, "BEGIN");
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages VALUES(?, 1, ?, ?)", -1, &insert, nullptr);
  const auto scans = open_log(log);
  std::int64_t id = 1'000'000;
  while (const auto entry = scans->next()) {
    const auto& scan = std::get<Scan>(entry->content);
    const std::string message = point_cloud2(scan, order);
    sqlite3_reset(insert);
    sqlite3_bind_int64(insert, 1, --id);
    sqlite3_bind_int64(insert, 2, scan.stamp_ns);
    sqlite3_bind_blob(
        insert, 3, message.data(), static_cast<int>(message.size()), SQLITE_TRANSIENT);
    if (sqlite3_step(insert) != SQLITE_DONE) throw std::runtime_error(sqlite3_errmsg(database));
  }
  sqlite3_finalize(insert);
  execute(database, "COMMIT");
  sqlite3_close(database);
}

fs::path recordings() {
  const char* data = std::getenv("KISSMAP_TEST_DATA");
  return data == nullptr ? fs::path() : fs::path(data);
}

void run_kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  const ProgramResult result = run_program(arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
}

void map_log(const fs::path& log, const fs::path& session) {
  run_kissmap({"run", log, "-o", session, "--quiet", "--no-products"});
}

void expect_same_map(const fs::path& a, const fs::path& b) {
  EXPECT_EQ(file_text(a / "trajectory.tum"), file_text(b / "trajectory.tum"));
  std::size_t maps = 0;
  for (const auto& file : fs::directory_iterator(a / "local_maps")) {
    EXPECT_EQ(file_text(file.path()), file_text(b / "local_maps" / file.path().filename()));
    ++maps;
  }
  EXPECT_GT(maps, 0U);
}

class RosBags : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (recordings().empty()) GTEST_SKIP() << "needs the recordings";
    log_ = recordings() / GetParam();
    map_log(log_, dir_.path() / "expected");
  }
  void expect_same(const fs::path& bag) {
    map_log(bag, dir_.path() / "found");
    expect_same_map(dir_.path() / "expected", dir_.path() / "found");
  }
  TempDir dir_;
  fs::path log_;
};

TEST_P(RosBags, OfRos1GiveTheMapOfTheFolder) {
  const ProgramResult import =
      run_program({KISSMAP_TEST_PYTHON, "-I", "-c", "import rosbag, nav_msgs.msg"});
  ASSERT_NE(import.exit_code, 127) << "no " KISSMAP_TEST_PYTHON;
  if (import.exit_code != 0) {
    GTEST_SKIP() << "needs rosbag (package python3-rosbag), which could not be loaded: "
                 << import.err;
  }
  const fs::path bag = dir_.path() / "log.bag";
  const ProgramResult written = run_program({KISSMAP_TEST_PYTHON,
                                             "-I",
                                             KISSMAP_CLIENT_SOURCES "/write_ros1_bag.py",
                                             log_,
                                             bag,
                                             "lz4",
                                             "300000"});
  ASSERT_EQ(written.exit_code, 0) << written.err;
  expect_same(bag);
}

TEST_P(RosBags, OfRos2GiveTheMapOfTheFolder) {
  fs::create_directory(dir_.path() / "bag");
  write_sqlite_bag(log_, dir_.path() / "bag" / "log_0.db3", 4, Cdr::LITTLE_ENDIANNESS);
  expect_same(dir_.path() / "bag");
}

/// A bag made by the program that knows the layouts of ROS 2 and MCAP, but nothing of kissmap.
fs::path write_ros2_bag(const fs::path& log, const fs::path& out, const std::string& form) {
  const ProgramResult written = run_program(
      {KISSMAP_TEST_PYTHON, "-I", KISSMAP_CLIENT_SOURCES "/write_ros2_bag.py", log, out, form});
  if (written.exit_code != 0) throw std::runtime_error(written.err);
  return out;
}

TEST_P(RosBags, OfMcapGiveTheMapOfTheFolder) {
  expect_same(write_ros2_bag(log_, dir_.path() / "log.mcap", "mcap-lz4"));
}

TEST_P(RosBags, ConvertedToMcapGiveTheMapOfTheFolder) {
  const fs::path file = dir_.path() / "log.mcap";
  run_kissmap({"convert", log_, "-o", file, "--to", "mcap", "--quiet"});
  expect_same(file);
}

INSTANTIATE_TEST_SUITE_P(Recordings,
                         RosBags,
                         testing::Values("campus_avia_loop", "hall_ouster"),
                         [](const auto& log) { return std::string(log.param); });

TEST(Ros1Bags, OfEveryCompressionReadInParts) {
  if (recordings().empty()) GTEST_SKIP() << "needs the recordings";
  const ProgramResult import =
      run_program({KISSMAP_TEST_PYTHON, "-I", "-c", "import rosbag, nav_msgs.msg"});
  ASSERT_NE(import.exit_code, 127) << "no " KISSMAP_TEST_PYTHON;
  if (import.exit_code != 0) {
    GTEST_SKIP() << "needs rosbag (package python3-rosbag), which could not be loaded: "
                 << import.err;
  }
  const fs::path log = recordings() / "campus_avia_loop";
  const auto expected = open_log(log);
  expected->skip(200);
  const auto wanted = expected->next();
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const TempDir dir;
    const fs::path bag = dir.path() / "log.bag";
    ASSERT_EQ(run_program({KISSMAP_TEST_PYTHON,
                           "-I",
                           KISSMAP_CLIENT_SOURCES "/write_ros1_bag.py",
                           log,
                           bag,
                           compression,
                           "300000"})
                  .exit_code,
              0);
    const auto found = open_log(bag);
    EXPECT_EQ(found->info().scan_count, 314U);
    EXPECT_EQ(found->info().topics.size(), 4U);
    found->skip(200);
    const auto entry = found->next();
    ASSERT_TRUE(entry.has_value());
    EXPECT_TRUE(std::get<Scan>(entry->content).points == std::get<Scan>(wanted->content).points);
    EXPECT_EQ(std::get<Scan>(entry->content).stamp_ns, std::get<Scan>(wanted->content).stamp_ns);
  }
}

TEST(Ros2Bags, OfEverySchemaAndByteOrder) {
  if (recordings().empty()) GTEST_SKIP() << "needs the recordings";
  const fs::path log = recordings() / "hall_ouster";
  const auto expected = open_log(log);
  const auto first = expected->next();
  for (const int version : {1, 2, 3, 4}) {
    const TempDir dir;
    const fs::path file = dir.path() / "log.db3";
    write_sqlite_bag(
        log, file, version, version % 2 == 0 ? Cdr::BIG_ENDIANNESS : Cdr::LITTLE_ENDIANNESS);
    const auto found = open_log(file);
    EXPECT_EQ(found->info().scan_count, 60U);
    const auto entry = found->next();
    ASSERT_TRUE(entry.has_value());
    const auto& scan = std::get<Scan>(entry->content);
    EXPECT_EQ(scan.stamp_ns, std::get<Scan>(first->content).stamp_ns);
    EXPECT_TRUE(scan.points == std::get<Scan>(first->content).points);
  }
}

class Ros2Forms : public testing::TestWithParam<const char*> {};

TEST_P(Ros2Forms, GiveEveryScan) {
  if (recordings().empty()) GTEST_SKIP() << "needs the recordings";
  const std::string form = GetParam();
  const bool is_file = form.starts_with("mcap-") && form != "mcap-bare";
  const TempDir dir;
  const fs::path log = recordings() / "campus_avia_loop";
  const auto found =
      open_log(write_ros2_bag(log, dir.path() / (is_file ? "log.mcap" : "log"), form));
  EXPECT_EQ(found->info().scan_count, 314U);
  ASSERT_EQ(found->info().topics.size(), 2U);
  EXPECT_EQ(found->info().topics[0].name, "/fix");
  const auto expected = open_log(log);
  while (const auto wanted = expected->next()) {
    const auto entry = found->next();
    ASSERT_TRUE(entry.has_value());
    ASSERT_TRUE(std::holds_alternative<Scan>(entry->content));
    const auto& scan = std::get<Scan>(entry->content);
    EXPECT_EQ(scan.stamp_ns, std::get<Scan>(wanted->content).stamp_ns);
    EXPECT_TRUE(scan.points == std::get<Scan>(wanted->content).points);
  }
  const auto after = found->next();
  EXPECT_EQ(after.has_value(), form == "mcap-cut");  // tells that the end is missing
  EXPECT_TRUE(!after || std::holds_alternative<RefusedScan>(after->content));
}

INSTANTIATE_TEST_SUITE_P(All,
                         Ros2Forms,
                         testing::Values("mcap-none",
                                         "mcap-lz4",
                                         "mcap-zstd",
                                         "mcap-unchunked",
                                         "mcap-cut",
                                         "db3",
                                         "db3-file",
                                         "db3-message",
                                         "mcap",
                                         "db3-bare",
                                         "db3-file-bare",
                                         "mcap-bare"),
                         [](const auto& form) {
                           std::string name = form.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace kissmap
