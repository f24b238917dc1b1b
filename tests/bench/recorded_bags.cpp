// SPDX-License-Identifier: MIT
// Bags of ROS 1 and ROS 2. Layouts: wiki.ros.org/Bags/Format/2.0, ros2/rosbag2.
#include <sqlite3.h>

#include <fstream>
#include <memory>
#include <stdexcept>

#include "bench/byte_text.hpp"
#include "bench/recorded_logs.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr const char* topic = "/points";

// Of ROS 1: seconds in the low, nanoseconds in the high half.
std::uint64_t ros1_time(std::size_t i) {
  return recorded_ns(i) / 1'000'000'000 | (recorded_ns(i) % 1'000'000'000) << 32U;
}

template <class T>
std::string ros1_field(const std::string& name, std::type_identity_t<T> value) {
  return ByteText().add_block(name + "=" + ByteText().add<T>(value).text()).text();
}
std::string ros1_text_field(const std::string& name, const std::string& value) {
  return ByteText().add_block(name + "=" + value).text();
}
std::string ros1_record(std::uint8_t op, const std::string& fields, std::string_view data) {
  return ByteText().add_block(ros1_field<std::uint8_t>("op", op) + fields).add_block(data).text();
}

std::string ros1_header(std::uint64_t index_offset, std::size_t chunks) {
  const std::string fields =
      ros1_field<std::uint64_t>("index_pos", index_offset) +
      ros1_field<std::uint32_t>("conn_count", 1) +
      ros1_field<std::uint32_t>("chunk_count", static_cast<std::uint32_t>(chunks));
  const std::string bare = ros1_record(3, fields, "");
  return ros1_record(3, fields, std::string(4096 - bare.size(), ' '));
}

void require(int result, sqlite3* database) {
  if (result != SQLITE_OK && result != SQLITE_DONE) {
    throw std::runtime_error(sqlite3_errmsg(database));
  }
}

}  // namespace

void write_ros1_bag(const fs::path& path, const RecordedClouds& clouds) {
  const std::string magic = "#ROSBAG V2.0\n";
  std::ofstream file(path, std::ios::binary);
  file << magic << ros1_header(0, 0);
  const std::string connection = ros1_record(
      7,
      ros1_field<std::uint32_t>("conn", 0) + ros1_text_field("topic", topic),
      ros1_text_field("topic", topic) + ros1_text_field("type", "sensor_msgs/PointCloud2"));
  std::string index = connection;
  for (std::size_t i = 0; i < clouds.count; ++i) {
    const std::string stamped = ros1_field<std::uint32_t>("conn", 0);
    const std::string records =
        (i == 0 ? connection : "") +
        ros1_record(2,
                    stamped + ros1_field<std::uint64_t>("time", ros1_time(i)),
                    cloud_message(clouds, i, false));
    const auto offset = static_cast<std::uint64_t>(file.tellp());
    const auto size = static_cast<std::uint32_t>(records.size());
    file << ros1_record(
        5,
        ros1_text_field("compression", "none") + ros1_field<std::uint32_t>("size", size),
        records);
    index += ros1_record(6,
                         ros1_field<std::uint32_t>("ver", 1) +
                             ros1_field<std::uint64_t>("chunk_pos", offset) +
                             ros1_field<std::uint64_t>("start_time", ros1_time(i)) +
                             ros1_field<std::uint64_t>("end_time", ros1_time(i)) +
                             ros1_field<std::uint32_t>("count", 1),
                         ByteText().add<std::uint32_t>(0).add<std::uint32_t>(1).text());
  }
  const auto index_offset = static_cast<std::uint64_t>(file.tellp());
  file << index;
  file.seekp(static_cast<std::streamoff>(magic.size()));
  file << ros1_header(index_offset, clouds.count);
}

void write_ros2_bag(const fs::path& path, const RecordedClouds& clouds) {
  sqlite3* raw = nullptr;
  require(sqlite3_open(path.c_str(), &raw), raw);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> database(raw, sqlite3_close);
  const char* begin =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
      " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
      " timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC);"
      "INSERT INTO topics VALUES (1, '/points', 'sensor_msgs/msg/PointCloud2', 'cdr', '');"
      "BEGIN";
  require(sqlite3_exec(raw, begin, nullptr, nullptr, nullptr), raw);
  sqlite3_stmt* insert = nullptr;
  require(sqlite3_prepare_v2(raw,
                             "INSERT INTO messages(topic_id, timestamp, data) VALUES (1, ?, ?)",
                             -1,
                             &insert,
                             nullptr),
          raw);
  for (std::size_t i = 0; i < clouds.count; ++i) {
    const std::string bytes = cloud_message(clouds, i, true);
    sqlite3_bind_int64(insert, 1, static_cast<std::int64_t>(recorded_ns(i)));
    sqlite3_bind_blob64(insert, 2, bytes.data(), bytes.size(), SQLITE_TRANSIENT);
    require(sqlite3_step(insert), raw);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  require(sqlite3_exec(raw, "COMMIT", nullptr, nullptr, nullptr), raw);
}

}  // namespace kissmap
