// SPDX-License-Identifier: MIT
#include "formats/clouds/text_cloud.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "formats/clouds/ascii_records.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

constexpr std::size_t max_columns = 64;
using Words = std::vector<std::string_view>;

bool separates(char c) {
  return is_space(c) || c == ',' || c == ';';
}

Words words_of(std::string_view line) {
  Words words;
  while (true) {
    const auto begin = std::ranges::find_if_not(line, separates);
    if (begin == line.end()) return words;
    const auto end = std::find_if(begin, line.end(), separates);
    words.emplace_back(begin, end);
    line = std::string_view(end, line.end());
  }
}

bool is_remark(std::string_view line) {
  const std::string_view text = trimmed(line);
  return text.empty() || text.starts_with('#') || text.starts_with("//");
}

bool is_number(std::string_view word) {
  std::vector<std::byte> ignored;
  return append_number(word, ScalarType::f64, ignored);
}

/// One field a column; stamps in seconds want all digits of a double.
std::vector<RecordField> fields_of(const Words& first, bool named) {
  constexpr const char* names[] = {"x", "y", "z", "intensity"};
  std::vector<RecordField> fields;
  const std::size_t size = sizeof(double);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const std::string name = named ? std::string(first[i]) : i < std::size(names) ? names[i] : "_";
    fields.push_back({name, ScalarType::f64, i * size, first.size() * size, 1});
  }
  return fields;
}

void append_line(const Words& words, std::size_t number, PointRecords& records) {
  const auto refuse = [&](const std::string& what) {
    throw Refusal(refusal_reason::broken_content, "line " + std::to_string(number) + ": " + what);
  };
  if (words.size() != records.layout.fields.size()) {
    refuse(std::to_string(words.size()) + " columns instead of " +
           std::to_string(records.layout.fields.size()));
  }
  for (const std::string_view word : words) {
    if (!append_number(word, ScalarType::f64, records.storage)) {
      refuse(in_quotes(word) + " is no number");
    }
  }
  ++records.count;
}

}  // namespace

PointRecords read_text_cloud(std::span<const std::byte> file) {
  PointRecords records;
  records.layout.byte_order = std::endian::native;
  Lines lines(text_of(file));
  while (const auto line = lines.next()) {
    if (is_remark(*line)) continue;
    const Words words = words_of(*line);
    if (records.layout.fields.empty()) {
      const bool named = !words.empty() && !is_number(words[0]);
      if (words.size() < 3 || words.size() > max_columns) {
        throw Refusal(refusal_reason::broken_header,
                      "line " + std::to_string(lines.number()) + ": " +
                          std::to_string(words.size()) + " columns; a point has 3 or more");
      }
      records.layout.fields = fields_of(words, named);
      if (named) continue;
    }
    append_line(words, lines.number(), records);
  }
  records.bytes = records.storage;
  return records;
}

}  // namespace kissmap
