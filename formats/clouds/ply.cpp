// SPDX-License-Identifier: MIT
#include "formats/clouds/ply.hpp"

#include <algorithm>
#include <charconv>
#include <string>

#include "formats/clouds/ascii_records.hpp"
#include "formats/clouds/gather.hpp"
#include "formats/clouds/ply_header.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

[[noreturn]] void refuse_short(const PlyElement& element, std::size_t place) {
  throw Refusal(refusal_reason::truncated,
                "byte " + std::to_string(place) + ": the file ends before " +
                    std::to_string(element.count) + " elements " + in_quotes(element.name) +
                    " are complete; is it cut?");
}

/// Walks through a binary payload and never past its end.
class Cursor {
 public:
  Cursor(std::span<const std::byte> file, const PlyHeader& header)
      : file_(file), position_(header.size), swap_(header.byte_order != std::endian::native) {}

  std::size_t position() const { return position_; }

  std::span<const std::byte> take(std::size_t size, const PlyElement& element) {
    if (size > file_.size() - position_) refuse_short(element, position_);
    position_ += size;
    return file_.subspan(position_ - size, size);
  }

  std::span<const std::byte> take_all(const PlyElement& element) {
    const std::size_t stride = element.stride();
    if (stride == 0) return {};
    if (element.count > (file_.size() - position_) / stride) refuse_short(element, position_);
    return take(element.count * stride, element);
  }

  void skip_list(const PlyProperty& property, const PlyElement& element) {
    const auto bytes = take(size_of(*property.list_count), element);
    const std::int64_t length = list_length(bytes, *property.list_count);
    const std::size_t value_size = size_of(property.type);
    const auto room = static_cast<std::int64_t>((file_.size() - position_) / value_size);
    if (length < 0 || length > room) refuse_short(element, position_);
    take(static_cast<std::size_t>(length) * value_size, element);
  }

 private:
  std::int64_t list_length(std::span<const std::byte> bytes, ScalarType type) const {
    using gather_detail::load;
    switch (type) {
      case ScalarType::i8:
        return load<std::int8_t>(bytes.data(), swap_);
      case ScalarType::u8:
        return load<std::uint8_t>(bytes.data(), swap_);
      case ScalarType::i16:
        return load<std::int16_t>(bytes.data(), swap_);
      case ScalarType::u16:
        return load<std::uint16_t>(bytes.data(), swap_);
      case ScalarType::i32:
        return load<std::int32_t>(bytes.data(), swap_);
      case ScalarType::u32:
        return load<std::uint32_t>(bytes.data(), swap_);
      default:
        return load<std::int64_t>(bytes.data(), swap_);
    }
  }

  std::span<const std::byte> file_;
  std::size_t position_;
  bool swap_;
};

// Packed fields of an element's single values; lists are left out.
std::vector<RecordField> fields_of(const PlyElement& element) {
  std::vector<RecordField> fields;
  std::size_t stride = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.list_count) continue;
    fields.push_back({property.name, property.type, stride, 0, 1});
    stride += size_of(property.type);
  }
  for (RecordField& field : fields) field.stride = stride;
  return fields;
}

// With lists, elements differ in size: only walking through them finds the next one.
void walk_elements(const PlyElement& element, Cursor& cursor, std::vector<std::byte>* values) {
  for (std::size_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (property.list_count) {
        cursor.skip_list(property, element);
        continue;
      }
      const auto value = cursor.take(size_of(property.type), element);
      if (values != nullptr) values->insert(values->end(), value.begin(), value.end());
    }
  }
}

PointRecords read_binary(std::span<const std::byte> file,
                         const PlyHeader& header,
                         std::size_t vertex_index) {
  Cursor cursor(file, header);
  for (std::size_t i = 0; i < vertex_index; ++i) {
    const PlyElement& element = header.elements[i];
    if (element.has_lists()) {
      walk_elements(element, cursor, nullptr);
    } else {
      cursor.take_all(element);
    }
  }
  const PlyElement& vertex = header.elements[vertex_index];
  PointRecords records;
  records.layout = {fields_of(vertex), header.byte_order};
  records.count = vertex.count;
  if (vertex.has_lists()) {
    walk_elements(vertex, cursor, &records.storage);
    records.bytes = records.storage;
  } else {
    records.bytes = cursor.take_all(vertex);
  }
  return records;
}

/// The line without the values of its lists.
std::string without_lists(std::string_view line, const PlyElement& element) {
  std::string result;
  for (const PlyProperty& property : element.properties) {
    const std::string_view word = next_word(line);
    if (!property.list_count) {
      result += std::string(word) + " ";
      continue;
    }
    std::size_t length = 0;
    std::from_chars(word.data(), word.data() + word.size(), length);
    for (; length > 0 && !line.empty(); --length) next_word(line);
  }
  return result + std::string(line);
}

PointRecords read_ascii(std::span<const std::byte> file,
                        const PlyHeader& header,
                        std::size_t vertex_index) {
  Lines lines(text_of(file.subspan(header.size)));
  const auto next_line = [&](const PlyElement& element) {
    const auto line = lines.next_not_blank();
    if (!line) refuse_short(element, file.size());
    return *line;
  };
  for (std::size_t e = 0; e < vertex_index; ++e) {
    if (header.elements[e].properties.empty()) continue;
    for (std::size_t i = 0; i < header.elements[e].count; ++i) next_line(header.elements[e]);
  }
  const PlyElement& vertex = header.elements[vertex_index];
  PointRecords records;
  records.layout = {fields_of(vertex), std::endian::native};
  records.count = vertex.count;
  for (std::size_t i = 0; i < vertex.count; ++i) {
    const std::string_view line = next_line(vertex);
    append_record(vertex.has_lists() ? without_lists(line, vertex) : std::string(line),
                  header.lines + lines.number(),
                  records.layout.fields,
                  records.storage);
  }
  records.bytes = records.storage;
  return records;
}

}  // namespace

bool looks_like_ply(std::span<const std::byte> first_bytes) {
  const std::string_view text = text_of(first_bytes);
  return text.starts_with("ply\n") || text.starts_with("ply\r\n");
}

PointRecords read_ply(std::span<const std::byte> file) {
  const PlyHeader header = read_ply_header(file);
  const auto vertex = std::ranges::find(header.elements, "vertex", &PlyElement::name);
  if (vertex == header.elements.end()) {
    throw Refusal(refusal_reason::no_coordinates, "the header declares no element 'vertex'");
  }
  if (fields_of(*vertex).empty()) {
    throw Refusal(refusal_reason::no_coordinates, "the element 'vertex' has no single values");
  }
  const auto index = static_cast<std::size_t>(vertex - header.elements.begin());
  return header.ascii ? read_ascii(file, header, index) : read_binary(file, header, index);
}

}  // namespace kissmap
