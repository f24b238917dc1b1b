// SPDX-License-Identifier: MIT
#include "formats/clouds/ascii_records.hpp"

#include <charconv>
#include <string>

#include "formats/clouds/refusal.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

template <class T>
bool append_as(std::string_view word, std::vector<std::byte>& out) {
  T value{};
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || stop != end) return false;
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof(T));
  return true;
}

}  // namespace

bool append_number(std::string_view word, ScalarType type, std::vector<std::byte>& out) {
  if (word.starts_with('+')) word.remove_prefix(1);
  switch (type) {
    case ScalarType::i8:
      return append_as<std::int8_t>(word, out);
    case ScalarType::u8:
      return append_as<std::uint8_t>(word, out);
    case ScalarType::i16:
      return append_as<std::int16_t>(word, out);
    case ScalarType::u16:
      return append_as<std::uint16_t>(word, out);
    case ScalarType::i32:
      return append_as<std::int32_t>(word, out);
    case ScalarType::u32:
      return append_as<std::uint32_t>(word, out);
    case ScalarType::i64:
      return append_as<std::int64_t>(word, out);
    case ScalarType::u64:
      return append_as<std::uint64_t>(word, out);
    case ScalarType::f32:
      return append_as<float>(word, out);
    case ScalarType::f64:
      return append_as<double>(word, out);
  }
  return false;
}

void append_record(std::string_view line,
                   std::size_t line_number,
                   const std::vector<RecordField>& fields,
                   std::vector<std::byte>& out) {
  const auto refuse = [&](const std::string& what) {
    throw Refusal(refusal_reason::broken_content,
                  "line " + std::to_string(line_number) + ": " + what);
  };
  for (const RecordField& field : fields) {
    for (std::size_t v = 0; v < field.count; ++v) {
      const std::string_view word = next_word(line);
      if (word.empty()) refuse("no value for field " + field.name + "; is the line cut?");
      if (!append_number(word, field.type, out)) {
        refuse(in_quotes(word) + " is no value for field " + field.name);
      }
    }
  }
  if (!trimmed(line).empty()) refuse("more values than fields");
}

}  // namespace kissmap
