// SPDX-License-Identifier: MIT
#include <array>

#include "formats/containers/byte_cursor.hpp"
#include "formats/messages/cloud_message.hpp"

namespace kissmap {
namespace {

using Bytes = std::span<const std::byte>;

/// One field on the wire.
struct WireField {
  std::uint32_t number = 0;
  std::uint64_t value = 0;  ///< varint, fixed 64 or fixed 32
  Bytes bytes;              ///< of a length-delimited one

  double real() const { return std::bit_cast<double>(value); }
};

std::uint64_t read_varint(ByteCursor& cursor) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const auto byte = cursor.value<std::uint8_t>();
    value |= std::uint64_t{byte & 0x7FU} << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  throw Refusal(refusal_reason::broken_content, "a protobuf number of more than 64 bits");
}

WireField read_field(ByteCursor& cursor) {
  const std::uint64_t tag = read_varint(cursor);
  WireField field;
  field.number = static_cast<std::uint32_t>(tag >> 3U);
  switch (tag & 7U) {
    case 0:
      field.value = read_varint(cursor);
      return field;
    case 1:
      field.value = cursor.value<std::uint64_t>();
      return field;
    case 2:
      field.bytes = cursor.take(read_varint(cursor));
      return field;
    case 5:
      field.value = cursor.value<std::uint32_t>();
      return field;
    default:
      throw Refusal(refusal_reason::broken_content, "a protobuf field of an unknown wire type");
  }
}

template <class Take>
void for_each_field(Bytes message, Take take) {
  ByteCursor cursor(message);
  while (cursor.left() > 0) take(read_field(cursor));
}

std::int64_t read_timestamp(Bytes message) {
  std::uint64_t ns = 0;  // what does not fit wraps around
  for_each_field(message, [&](const WireField& field) {
    if (field.number == 1) ns += field.value * 1'000'000'000U;
    if (field.number == 2) ns += field.value;
  });
  return static_cast<std::int64_t>(ns);
}

/// Numbered otherwise than in sensor_msgs/PointField.
std::optional<ScalarType> scalar_type(std::uint64_t number) {
  constexpr std::array types{ScalarType::u8,
                             ScalarType::i8,
                             ScalarType::u16,
                             ScalarType::i16,
                             ScalarType::u32,
                             ScalarType::i32,
                             ScalarType::f32,
                             ScalarType::f64};
  if (number < 1 || number > types.size()) return std::nullopt;
  return types[number - 1];
}

std::optional<RecordField> read_element(Bytes message) {
  RecordField element;
  std::uint64_t type = 0;
  for_each_field(message, [&](const WireField& field) {
    if (field.number == 1)
      element.name.assign(reinterpret_cast<const char*>(field.bytes.data()), field.bytes.size());
    if (field.number == 2) element.offset = field.value;
    if (field.number == 3) type = field.value;
  });
  const auto known = scalar_type(type);
  if (!known) return std::nullopt;
  element.type = *known;
  return element;
}

template <std::size_t size>
std::array<double, size> read_reals(Bytes message) {
  std::array<double, size> reals{};
  for_each_field(message, [&](const WireField& field) {
    if (field.number >= 1 && field.number <= size) reals[field.number - 1] = field.real();
  });
  return reals;
}

std::optional<Eigen::Isometry3d> read_pose(Bytes message) {
  std::array<double, 3> position{};
  std::array<double, 4> turn{};
  for_each_field(message, [&](const WireField& field) {
    if (field.number == 1) position = read_reals<3>(field.bytes);
    if (field.number == 2) turn = read_reals<4>(field.bytes);
  });
  Eigen::Quaterniond rotation(turn[3], turn[0], turn[1], turn[2]);
  // An orientation left out is all zeros.
  if (!(rotation.squaredNorm() > 0.0)) rotation.setIdentity();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = Eigen::Vector3d(position[0], position[1], position[2]);
  if (!pose.matrix().allFinite()) {
    throw Refusal(refusal_reason::broken_content, "the pose of the cloud is not finite");
  }
  if (pose.matrix() == Eigen::Matrix4d::Identity()) return std::nullopt;
  return pose;
}

}  // namespace

CloudMessage read_foxglove_cloud(Bytes message) {
  CloudMessage cloud;
  RecordLayout& layout = cloud.records.layout;
  std::uint64_t stride = 0;
  for_each_field(message, [&](const WireField& field) {
    if (field.number == 1) cloud.stamp_ns = read_timestamp(field.bytes);
    if (field.number == 2)
      cloud.frame.assign(reinterpret_cast<const char*>(field.bytes.data()), field.bytes.size());
    if (field.number == 3) cloud.frame_from_points = read_pose(field.bytes);
    if (field.number == 4) stride = field.value;
    if (field.number == 5) {
      if (auto element = read_element(field.bytes)) layout.fields.push_back(std::move(*element));
    }
    if (field.number == 6) cloud.records.bytes = field.bytes;
  });
  const std::size_t size = cloud.records.bytes.size();
  if (size == 0) return cloud;
  if (stride == 0 || size % stride != 0) {
    throw Refusal(
        refusal_reason::wrong_size,
        std::to_string(size) + " bytes of points of " + std::to_string(stride) + " bytes each");
  }
  cloud.records.count = size / stride;
  for (RecordField& field : layout.fields) {
    field.stride = stride;
    if (field.offset > stride || size_of(field.type) > stride - field.offset) {
      throw Refusal(refusal_reason::broken_header, "field " + field.name + " ends beyond a point");
    }
  }
  return cloud;
}

}  // namespace kissmap
