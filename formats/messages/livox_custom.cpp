// SPDX-License-Identifier: MIT
#include <cmath>

#include "formats/messages/cloud_message.hpp"
#include "formats/messages/message_reader.hpp"

namespace kissmap {
namespace {

constexpr std::size_t point_size = 19;          // bytes
constexpr std::size_t aligned_point_size = 20;  // in CDR each begins with a 32-bit number
constexpr double same_clock_ns = 1e9;

}  // namespace

CloudMessage read_livox_custom(std::span<const std::byte> message, MessageEncoding encoding) {
  MessageReader reader(message, encoding);
  MessageHeader header = read_header(reader);
  const auto timebase_ns = static_cast<std::int64_t>(reader.value<std::uint64_t>());
  reader.value<std::uint32_t>();  // number of points, told again by the sequence
  reader.take(4);                 // number of the sensor, reserved
  const std::size_t stride = reader.is_cdr() ? aligned_point_size : point_size;
  const std::uint32_t count = reader.length(point_size);

  CloudMessage cloud;
  cloud.frame = std::move(header.frame);
  // Times count from the time base, which is the header's stamp unless the sensor's clock is
  // another than the computer's.
  const double apart_ns = static_cast<double>(timebase_ns) - static_cast<double>(header.stamp_ns);
  const bool one_clock = std::abs(apart_ns) < same_clock_ns;
  cloud.stamp_ns = one_clock ? timebase_ns : header.stamp_ns;
  if (count > 0) reader.align(4);
  const std::uint64_t size = count == 0 ? 0 : std::uint64_t{count - 1} * stride + point_size;
  cloud.records.bytes = reader.take(size);
  cloud.records.count = count;
  RecordLayout& layout = cloud.records.layout;
  layout.byte_order = reader.byte_order();
  layout.fields = {{"offset_time", ScalarType::u32, 0, stride, 1},
                   {"x", ScalarType::f32, 4, stride, 1},
                   {"y", ScalarType::f32, 8, stride, 1},
                   {"z", ScalarType::f32, 12, stride, 1},
                   {"reflectivity", ScalarType::u8, 16, stride, 1}};
  return cloud;
}

}  // namespace kissmap
