// SPDX-License-Identifier: MIT
#include "formats/clouds/npy.hpp"

#include <charconv>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "formats/clouds/refusal.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

constexpr std::string_view magic = "\x93NUMPY";
constexpr std::size_t max_columns = 64;

[[noreturn]] void refuse(const std::string& what) {
  throw Refusal(refusal_reason::broken_header, what);
}

/// The header, a Python dictionary of a few known forms, and what follows it.
struct NpyParts {
  std::string_view header;
  std::span<const std::byte> data;
};

NpyParts split(std::span<const std::byte> file) {
  const std::string_view text = text_of(file);
  if (!text.starts_with(magic) || file.size() < 10) refuse("not a NumPy array");
  const auto byte = [&](std::size_t i) { return std::to_integer<std::size_t>(file[i]); };
  const std::size_t length_bytes = byte(6) == 1 ? 2 : 4;
  const std::size_t begin = 8 + length_bytes;
  if (byte(6) < 1 || byte(6) > 3) refuse("version " + std::to_string(byte(6)) + " is not known");
  if (file.size() < begin) throw Refusal(refusal_reason::truncated, "the file ends in its header");
  std::size_t length = 0;
  for (std::size_t i = length_bytes; i-- > 0;) length = (length << 8U) + byte(8 + i);
  if (length > file.size() - begin) {
    throw Refusal(refusal_reason::truncated, "the file ends in its header");
  }
  return {text.substr(begin, length), file.subspan(begin + length)};
}

/// What follows 'key': in the dictionary.
std::string_view value_of(std::string_view header, const char* key) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    const std::size_t found = header.find(quoted);
    if (found == std::string_view::npos) continue;
    const std::size_t colon = header.find(':', found + quoted.size());
    if (colon != std::string_view::npos) return trimmed(header.substr(colon + 1));
  }
  refuse(std::string("no '") + key + "' in its header");
}

struct NumberType {
  ScalarType type = ScalarType::f32;
  std::endian order = std::endian::little;
};

NumberType number_type(std::string_view descr) {
  NumberType found;
  if (descr.starts_with('>')) found.order = std::endian::big;
  if (!descr.empty() && std::string_view("<>=|").find(descr[0]) != std::string_view::npos) {
    descr.remove_prefix(1);
  }
  constexpr std::pair<std::string_view, ScalarType> types[] = {{"f4", ScalarType::f32},
                                                               {"f8", ScalarType::f64},
                                                               {"i1", ScalarType::i8},
                                                               {"u1", ScalarType::u8},
                                                               {"i2", ScalarType::i16},
                                                               {"u2", ScalarType::u16},
                                                               {"i4", ScalarType::i32},
                                                               {"u4", ScalarType::u32},
                                                               {"i8", ScalarType::i64},
                                                               {"u8", ScalarType::u64}};
  for (const auto& [name, type] : types) {
    if (descr != name) continue;
    found.type = type;
    return found;
  }
  refuse("numbers of type " + in_quotes(descr) + " are not read");
}

/// The text between the next pair of quotes, taken off the front.
std::optional<std::string_view> next_quoted(std::string_view& text) {
  const std::size_t begin = text.find_first_of("'\"");
  if (begin == std::string_view::npos) return std::nullopt;
  const std::size_t end = text.find(text[begin], begin + 1);
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view quoted = text.substr(begin + 1, end - begin - 1);
  text.remove_prefix(end + 1);
  return quoted;
}

std::vector<std::size_t> shape_of(std::string_view value) {
  std::vector<std::size_t> shape;
  if (!value.starts_with('(')) refuse("its shape is no tuple");
  value = value.substr(1, value.find(')') - 1);
  while (true) {
    value = trimmed(value);
    std::size_t size = 0;
    const auto [stop, error] = std::from_chars(value.data(), value.data() + value.size(), size);
    if (error != std::errc()) break;
    shape.push_back(size);
    value.remove_prefix(static_cast<std::size_t>(stop - value.data()));
    const std::size_t comma = value.find(',');
    if (comma == std::string_view::npos) break;
    value.remove_prefix(comma + 1);
  }
  return shape;
}

void require_size(std::size_t count, std::size_t record, std::size_t there) {
  if (record == 0 || count <= there / record) return;
  throw Refusal(refusal_reason::truncated,
                std::to_string(count) + " points of " + std::to_string(record) + " bytes in " +
                    std::to_string(there) + " bytes of data");
}

PointRecords read_structured(std::string_view descr,
                             const std::vector<std::size_t>& shape,
                             std::span<const std::byte> data) {
  if (shape.size() != 1) refuse("an array of records with more than one dimension");
  PointRecords records;
  std::size_t record = 0;
  std::string_view rest = descr.substr(0, descr.find(']'));
  std::optional<std::endian> order;
  while (const auto name = next_quoted(rest)) {
    const auto type = next_quoted(rest);
    if (!type || records.layout.fields.size() >= max_columns) refuse("its fields are not read");
    const NumberType number = number_type(*type);
    if (size_of(number.type) > 1 && order && *order != number.order) {
      refuse("fields of both byte orders");
    }
    if (size_of(number.type) > 1) order = number.order;
    records.layout.fields.push_back({std::string(*name), number.type, record, 0, 1});
    record += size_of(number.type);
  }
  require_size(shape[0], record, data.size());
  for (RecordField& field : records.layout.fields) field.stride = record;
  records.layout.byte_order = order.value_or(std::endian::little);
  records.count = record == 0 ? 0 : shape[0];
  records.bytes = data;
  return records;
}

PointRecords read_columns(std::string_view descr,
                          const std::vector<std::size_t>& shape,
                          bool fortran,
                          std::span<const std::byte> data) {
  if (shape.size() != 2 || shape[1] < 3 || shape[1] > max_columns) {
    refuse("an array of points has the shape (points, 3 or more columns)");
  }
  std::string_view quoted = descr;
  const auto type = next_quoted(quoted);
  if (!type) refuse("its numbers have no type");
  const NumberType number = number_type(*type);
  const std::size_t size = size_of(number.type);
  require_size(shape[0], shape[1] * size, data.size());
  PointRecords records;
  records.layout.byte_order = number.order;
  constexpr const char* names[] = {"x", "y", "z", "intensity"};
  for (std::size_t i = 0; i < shape[1]; ++i) {
    records.layout.fields.push_back({i < std::size(names) ? names[i] : "_",
                                     number.type,
                                     fortran ? i * size * shape[0] : i * size,
                                     fortran ? size : shape[1] * size,
                                     1});
  }
  records.count = shape[0];
  records.bytes = data;
  return records;
}

}  // namespace

PointRecords read_npy(std::span<const std::byte> file) {
  const NpyParts parts = split(file);
  const std::string_view descr = value_of(parts.header, "descr");
  const bool fortran = value_of(parts.header, "fortran_order").starts_with("True");
  const std::vector<std::size_t> shape = shape_of(value_of(parts.header, "shape"));
  if (descr.starts_with('[')) return read_structured(descr, shape, parts.data);
  return read_columns(descr, shape, fortran, parts.data);
}

}  // namespace kissmap
