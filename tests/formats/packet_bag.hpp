// SPDX-License-Identifier: MIT
// Packets out of ROS 2 bags of drivers' messages, and the cloud another decoder made of them: just
// enough for recordings known to be whole.
#pragma once

#include <sqlite3.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace kissmap::test {

struct RecordedPacket {
  std::int64_t received_ns = 0;
  std::vector<std::byte> payload;
};

/// Bytes of a message after CDR's four, read from front to back.
class CdrBytes {
 public:
  CdrBytes(const std::byte* data, std::size_t size) : data_(data), size_(size) {}

  std::uint32_t u32() {
    at_ = (at_ + 3) / 4 * 4;
    std::uint32_t value = 0;
    std::memcpy(&value, take(sizeof(value)), sizeof(value));
    return value;
  }
  std::int64_t time_ns() {
    const std::int64_t seconds = static_cast<std::int32_t>(u32());
    return seconds * 1'000'000'000 + u32();
  }
  const std::byte* take(std::size_t count) {
    if (size_ - at_ < count) throw std::runtime_error("the message is too short");
    const std::byte* here = data_ + at_;
    at_ += count;
    return here;
  }

 private:
  const std::byte* data_;
  std::size_t size_;
  std::size_t at_ = 0;
};

/// Of a velodyne_msgs/VelodyneScan (1206 bytes each) or a pandar_msgs/PandarScan (1500 and a size).
inline void append_packets(CdrBytes message, bool velodyne, std::vector<RecordedPacket>& packets) {
  constexpr std::size_t velodyne_size = 1206;
  constexpr std::size_t pandar_room = 1500;
  message.time_ns();
  message.take(message.u32());  // the frame's name
  for (std::uint32_t left = message.u32(); left > 0; --left) {
    RecordedPacket packet;
    packet.received_ns = message.time_ns();
    const std::byte* bytes = message.take(velodyne ? velodyne_size : pandar_room);
    packet.payload.assign(bytes, bytes + (velodyne ? velodyne_size : message.u32()));
    packets.push_back(std::move(packet));
  }
}

/// All packets of the only topic of a bag's file, or those of its first messages, in recorded
/// order.
inline std::vector<RecordedPacket> read_packet_bag(
    const std::filesystem::path& file,
    std::size_t most_messages = std::numeric_limits<std::size_t>::max()) {
  sqlite3* opened = nullptr;
  const std::string address = "file:" + file.string() + "?immutable=1";
  const int open =
      sqlite3_open_v2(address.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  const std::unique_ptr<sqlite3, int (*)(sqlite3*)> bag(opened, sqlite3_close);
  sqlite3_stmt* prepared = nullptr;
  if (open != SQLITE_OK ||
      sqlite3_prepare_v2(bag.get(),
                         "SELECT t.type, m.data FROM messages m JOIN topics t ON t.id = m.topic_id "
                         "ORDER BY m.timestamp, m.id",
                         -1,
                         &prepared,
                         nullptr) != SQLITE_OK) {
    throw std::runtime_error(file.string() + ": " + sqlite3_errmsg(bag.get()));
  }
  const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> rows(prepared, sqlite3_finalize);
  constexpr std::size_t encapsulation = 4;
  std::vector<RecordedPacket> packets;
  for (; most_messages > 0 && sqlite3_step(rows.get()) == SQLITE_ROW; --most_messages) {
    const std::string type = reinterpret_cast<const char*>(sqlite3_column_text(rows.get(), 0));
    const auto* data = static_cast<const std::byte*>(sqlite3_column_blob(rows.get(), 1));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(rows.get(), 1));
    append_packets({data + encapsulation, size - encapsulation},
                   type.find("Velodyne") != std::string::npos,
                   packets);
  }
  return packets;
}

/// Coordinates of a binary PCD whose fields begin with x y z as 32-bit floats.
inline std::vector<Eigen::Vector3d> read_reference_cloud(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::size_t stride = 0;
  std::size_t count = 0;
  for (std::string line; std::getline(in, line) && line.rfind("DATA", 0) != 0;) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "POINTS") words >> count;
    for (std::size_t size = 0; key == "SIZE" && words >> size;) stride += size;
  }
  std::vector<Eigen::Vector3d> points;
  std::vector<char> record(stride);
  while (points.size() < count && in.read(record.data(), static_cast<std::streamsize>(stride))) {
    Eigen::Vector3f point;
    std::memcpy(point.data(), record.data(), sizeof(float) * 3);
    points.push_back(point.cast<double>());
  }
  return points;
}

/// The one file of this extension in a folder or in the folders in it that come first by name.
inline std::filesystem::path only_file(const std::filesystem::path& folder, const char* extension) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == extension) found.push_back(entry.path());
  }
  if (found.empty()) throw std::runtime_error(folder.string() + " has no file of " + extension);
  return *std::min_element(found.begin(), found.end());
}

}  // namespace kissmap::test
