// SPDX-License-Identifier: MIT
// Writes messages of ROS 1, ROS 2 and protobuf byte by byte, as their layouts are published.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kissmap::test {

static_assert(std::endian::native == std::endian::little);

/// Bytes given as hexadecimal digits, with spaces between them wherever they help to read.
inline std::string hex(std::string_view digits) {
  constexpr std::string_view values = "0123456789ABCDEF";
  std::string bytes;
  bool half = false;
  for (const char digit : digits) {
    if (digit == ' ') continue;
    const auto value = static_cast<unsigned>(values.find(digit));
    if (half) {
      bytes.back() = static_cast<char>(static_cast<unsigned char>(bytes.back()) << 4U | value);
    } else {
      bytes.push_back(static_cast<char>(value));
    }
    half = !half;
  }
  return bytes;
}

inline std::string turned(std::string bytes) {
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

template <class T>
std::string little(std::type_identity_t<T> value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

enum class RosForm : std::uint8_t { ros1, cdr_little, cdr_big };
inline constexpr std::array ros_forms{RosForm::ros1, RosForm::cdr_little, RosForm::cdr_big};

/// Members of a message one after the other. In CDR each number lies at a multiple of its size,
/// counted from behind the four bytes at the front, and a text has a zero at its end.
class RosBytes {
 public:
  explicit RosBytes(RosForm form) : form_(form) {
    if (is_cdr()) bytes_ = hex(form == RosForm::cdr_little ? "00 01 00 00" : "00 00 00 00");
  }

  template <class T>
  RosBytes& add(std::type_identity_t<T> value) {
    if (is_cdr()) {
      while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_ += '\0';
    }
    const std::string bytes = little<T>(value);
    bytes_ += form_ == RosForm::cdr_big ? turned(bytes) : bytes;
    return *this;
  }
  RosBytes& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  /// uint8[]
  RosBytes& sequence(std::string_view bytes) {
    return add<std::uint32_t>(static_cast<std::uint32_t>(bytes.size())).raw(bytes);
  }
  RosBytes& text(std::string text) {
    if (is_cdr()) text += '\0';
    return sequence(text);
  }
  RosBytes& time(std::uint32_t seconds, std::uint32_t nanoseconds) {
    return add<std::uint32_t>(seconds).add<std::uint32_t>(nanoseconds);
  }
  /// std_msgs/Header
  RosBytes& header(std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& frame) {
    if (!is_cdr()) add<std::uint32_t>(4711);  // how many there were before
    return time(seconds, nanoseconds).text(frame);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  bool is_cdr() const { return form_ != RosForm::ros1; }

  RosForm form_;
  std::string bytes_;
};

/// sensor_msgs/PointField
struct FieldOfCloud {
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 7;
  std::uint32_t count = 1;
};

/// sensor_msgs/PointCloud2
struct CloudOfBytes {
  std::uint32_t seconds = 1'700'000'000;
  std::uint32_t nanoseconds = 0;
  std::string frame = "lidar";
  std::uint32_t height = 1;
  std::uint32_t width = 0;
  std::vector<FieldOfCloud> fields;
  bool big_endian = false;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::string data;
};

inline std::string point_cloud2(RosForm form, const CloudOfBytes& cloud) {
  RosBytes bytes(form);
  bytes.header(cloud.seconds, cloud.nanoseconds, cloud.frame);
  bytes.add<std::uint32_t>(cloud.height).add<std::uint32_t>(cloud.width);
  bytes.add<std::uint32_t>(static_cast<std::uint32_t>(cloud.fields.size()));
  for (const FieldOfCloud& field : cloud.fields) {
    bytes.text(field.name).add<std::uint32_t>(field.offset).add<std::uint8_t>(field.datatype);
    bytes.add<std::uint32_t>(field.count);
  }
  bytes.add<std::uint8_t>(cloud.big_endian ? 1 : 0);
  bytes.add<std::uint32_t>(cloud.point_step).add<std::uint32_t>(cloud.row_step);
  return bytes.sequence(cloud.data).add<std::uint8_t>(0).bytes();
}

/// x y z as 32-bit floats, nothing else.
inline CloudOfBytes plain_cloud(const std::vector<std::array<float, 3>>& points) {
  CloudOfBytes cloud;
  cloud.width = static_cast<std::uint32_t>(points.size());
  cloud.fields = {{"x", 0}, {"y", 4}, {"z", 8}};
  cloud.point_step = 12;
  cloud.row_step = 12 * cloud.width;
  for (const auto& point : points) {
    for (const float coordinate : point) cloud.data += little<float>(coordinate);
  }
  return cloud;
}

/// A message of protobuf: a tag of number and wire type before each field.
class ProtobufBytes {
 public:
  ProtobufBytes& varint(unsigned number, std::uint64_t value) { return tag(number, 0).put(value); }
  ProtobufBytes& fixed64(unsigned number, double value) {
    tag(number, 1).bytes_ += little<double>(value);
    return *this;
  }
  ProtobufBytes& block(unsigned number, std::string_view bytes) {
    tag(number, 2).put(bytes.size()).bytes_ += bytes;
    return *this;
  }
  ProtobufBytes& fixed32(unsigned number, std::uint32_t value) {
    tag(number, 5).bytes_ += little<std::uint32_t>(value);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  ProtobufBytes& tag(unsigned number, unsigned wire_type) { return put(number * 8 + wire_type); }
  ProtobufBytes& put(std::uint64_t value) {
    for (; value > 127; value /= 128) bytes_ += static_cast<char>(128 + value % 128);
    bytes_ += static_cast<char>(value);
    return *this;
  }

  std::string bytes_;
};

}  // namespace kissmap::test
