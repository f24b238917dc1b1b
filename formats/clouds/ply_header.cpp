// SPDX-License-Identifier: MIT
#include "formats/clouds/ply_header.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "formats/clouds/refusal.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

[[noreturn]] void refuse(const Lines& lines, const std::string& what) {
  throw Refusal(refusal_reason::broken_header,
                "line " + std::to_string(lines.number()) + ": " + what);
}

std::optional<ScalarType> type_named(std::string_view name) {
  struct Known {
    std::string_view name;
    ScalarType type;
  };
  constexpr Known known[] = {{"char", ScalarType::i8},
                             {"int8", ScalarType::i8},
                             {"uchar", ScalarType::u8},
                             {"uint8", ScalarType::u8},
                             {"short", ScalarType::i16},
                             {"int16", ScalarType::i16},
                             {"ushort", ScalarType::u16},
                             {"uint16", ScalarType::u16},
                             {"int", ScalarType::i32},
                             {"int32", ScalarType::i32},
                             {"uint", ScalarType::u32},
                             {"uint32", ScalarType::u32},
                             {"int64", ScalarType::i64},
                             {"uint64", ScalarType::u64},
                             {"float", ScalarType::f32},
                             {"float32", ScalarType::f32},
                             {"double", ScalarType::f64},
                             {"float64", ScalarType::f64}};
  const auto* found = std::ranges::find(known, name, &Known::name);
  return found == std::end(known) ? std::nullopt : std::optional(found->type);
}

ScalarType type_or_refuse(const Lines& lines, std::string_view name) {
  if (const auto type = type_named(name)) return *type;
  refuse(lines, in_quotes(name) + " is no PLY type");
}

void read_format(const Lines& lines, std::string_view rest, PlyHeader& header) {
  const std::string_view encoding = next_word(rest);
  const std::string_view version = next_word(rest);
  header.ascii = encoding == "ascii";
  header.byte_order = encoding == "binary_big_endian" ? std::endian::big : std::endian::little;
  if (!header.ascii && encoding != "binary_little_endian" && encoding != "binary_big_endian") {
    refuse(lines, "there is no PLY format " + in_quotes(encoding));
  }
  if (version != "1.0") refuse(lines, "PLY version " + in_quotes(version) + " instead of 1.0");
}

PlyElement read_element(const Lines& lines, std::string_view rest) {
  PlyElement element;
  element.name = std::string(next_word(rest));
  const std::string_view count = next_word(rest);
  const char* end = count.data() + count.size();
  const auto [stop, error] = std::from_chars(count.data(), end, element.count);
  if (error != std::errc() || stop != end) {
    refuse(lines, in_quotes(count) + " is no number of elements");
  }
  return element;
}

PlyProperty read_property(const Lines& lines, std::string_view rest) {
  PlyProperty property;
  std::string_view type = next_word(rest);
  if (type == "list") {
    property.list_count = type_or_refuse(lines, next_word(rest));
    if (*property.list_count == ScalarType::f32 || *property.list_count == ScalarType::f64) {
      refuse(lines, "a list's length cannot be a fraction");
    }
    type = next_word(rest);
  }
  property.type = type_or_refuse(lines, type);
  property.name = std::string(next_word(rest));
  if (property.name.empty()) refuse(lines, "a property without a name");
  return property;
}

// Returns false at the end of the header.
bool read_entry(const Lines& lines, std::string_view line, PlyHeader& header, bool& has_format) {
  const std::string_view keyword = next_word(line);
  if (keyword == "end_header") return false;
  if (keyword == "format") {
    read_format(lines, line, header);
    has_format = true;
  } else if (keyword == "element") {
    header.elements.push_back(read_element(lines, line));
  } else if (keyword == "property") {
    if (header.elements.empty()) refuse(lines, "a property before any element");
    header.elements.back().properties.push_back(read_property(lines, line));
  } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
    refuse(lines, in_quotes(keyword) + " is no PLY header entry");
  }
  return true;
}

}  // namespace

bool PlyElement::has_lists() const {
  return std::ranges::any_of(properties, [](const auto& p) { return p.list_count.has_value(); });
}

std::size_t PlyElement::stride() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += size_of(property.type);
  return bytes;
}

PlyHeader read_ply_header(std::span<const std::byte> file) {
  PlyHeader header;
  Lines lines(text_of(file));
  bool has_format = false;
  const auto magic = lines.next();
  if (!magic || *magic != "ply") refuse(lines, "a PLY file begins with the line 'ply'");
  bool more = true;
  while (more) {
    const auto line = lines.next();
    if (!line) {
      throw Refusal(refusal_reason::truncated,
                    "the header ends after line " + std::to_string(lines.number()) +
                        " without end_header; is the file cut?");
    }
    more = read_entry(lines, *line, header, has_format);
  }
  if (!has_format) refuse(lines, "the header has no format line");
  header.size = lines.position();
  header.lines = lines.number();
  return header;
}

}  // namespace kissmap
