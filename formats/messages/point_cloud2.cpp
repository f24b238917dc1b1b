// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>

#include "formats/messages/cloud_message.hpp"
#include "formats/messages/message_reader.hpp"

namespace kissmap {
namespace {

constexpr std::uint32_t max_fields = 1000;

std::optional<ScalarType> scalar_type(std::uint8_t datatype) {
  constexpr std::array types{ScalarType::i8,
                             ScalarType::u8,
                             ScalarType::i16,
                             ScalarType::u16,
                             ScalarType::i32,
                             ScalarType::u32,
                             ScalarType::f32,
                             ScalarType::f64};
  if (datatype < 1 || datatype > types.size()) return std::nullopt;
  return types[datatype - 1U];
}

std::vector<RecordField> read_fields(MessageReader& reader) {
  const std::uint32_t count = reader.length(13);
  if (count > max_fields) {
    throw Refusal(refusal_reason::broken_header, std::to_string(count) + " fields in one point");
  }
  std::vector<RecordField> fields;
  for (std::uint32_t i = 0; i < count; ++i) {
    RecordField field;
    field.name = std::string(reader.text());
    field.offset = reader.value<std::uint32_t>();
    const auto type = scalar_type(reader.value<std::uint8_t>());
    // Some drivers leave the count of a single value at 0.
    field.count = std::max(1U, reader.value<std::uint32_t>());
    if (!type) continue;  // of a type nobody knows: not one of those that are read
    field.type = *type;
    fields.push_back(std::move(field));
  }
  return fields;
}

void require_inside_point(const std::vector<RecordField>& fields, std::uint32_t point_step) {
  for (const RecordField& field : fields) {
    const std::uint64_t end = field.offset + std::uint64_t{field.count} * size_of(field.type);
    if (end > point_step) {
      throw Refusal(refusal_reason::broken_header,
                    "field " + field.name + " ends at byte " + std::to_string(end) +
                        " of points of " + std::to_string(point_step) + " bytes");
    }
  }
}

struct Rows {
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;

  std::uint64_t row_bytes() const { return std::uint64_t{width} * point_step; }
  /// From row to row. Some writers leave row_step at 0.
  std::uint64_t stride() const {
    return height > 1 && row_step >= row_bytes() ? row_step : row_bytes();
  }
  std::uint64_t count() const { return std::uint64_t{height} * width; }
};

void require_data(const Rows& rows, std::size_t there) {
  if (rows.count() == 0) return;
  // Of the last row only its points must be there.
  const bool overflow = rows.height > 1 && rows.stride() > there / (rows.height - 1U) + 1U;
  const std::uint64_t wanted = overflow ? 0 : (rows.height - 1U) * rows.stride() + rows.row_bytes();
  if (overflow || wanted > there || rows.point_step == 0) {
    throw Refusal(refusal_reason::truncated,
                  std::to_string(rows.height) + " x " + std::to_string(rows.width) + " points of " +
                      std::to_string(rows.point_step) + " bytes in " + std::to_string(there) +
                      " bytes of data");
  }
}

// Rows with padding behind them are put together: a column has one stride.
void place_rows(const Rows& rows, std::span<const std::byte> data, PointRecords& records) {
  if (rows.count() == 0 || rows.stride() == rows.row_bytes()) {
    records.bytes = data;
    return;
  }
  records.storage.reserve(rows.count() * rows.point_step);
  for (std::uint64_t row = 0; row < rows.height; ++row) {
    const auto bytes = data.subspan(row * rows.stride(), rows.row_bytes());
    records.storage.insert(records.storage.end(), bytes.begin(), bytes.end());
  }
  records.bytes = records.storage;
}

}  // namespace

CloudMessage read_point_cloud2(std::span<const std::byte> message, MessageEncoding encoding) {
  MessageReader reader(message, encoding);
  MessageHeader header = read_header(reader);
  CloudMessage cloud;
  cloud.stamp_ns = header.stamp_ns;
  cloud.frame = std::move(header.frame);
  Rows rows;
  rows.height = reader.value<std::uint32_t>();
  rows.width = reader.value<std::uint32_t>();
  RecordLayout& layout = cloud.records.layout;
  layout.fields = read_fields(reader);
  layout.byte_order = reader.value<std::uint8_t>() != 0 ? std::endian::big : std::endian::little;
  rows.point_step = reader.value<std::uint32_t>();
  rows.row_step = reader.value<std::uint32_t>();
  const auto data = reader.bytes();
  require_inside_point(layout.fields, rows.point_step);
  require_data(rows, data.size());
  for (RecordField& field : layout.fields) field.stride = rows.point_step;
  cloud.records.count = rows.count();
  place_rows(rows, data, cloud.records);
  return cloud;
}

}  // namespace kissmap
