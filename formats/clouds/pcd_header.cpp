// SPDX-License-Identifier: MIT
#include "formats/clouds/pcd_header.hpp"

#include <charconv>
#include <map>
#include <optional>
#include <string_view>

#include "formats/clouds/refusal.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

/// No descriptor PCL knows is larger; a bigger record is damage. [bytes]
constexpr std::uint64_t max_stride = 1 << 20;

struct Entry {
  std::vector<std::string_view> words;  ///< behind the keyword
  std::size_t line = 0;
};

[[noreturn]] void refuse(std::size_t line, const std::string& what) {
  throw Refusal(refusal_reason::broken_header, "line " + std::to_string(line) + ": " + what);
}

/// Header lines by keyword, up to and including DATA.
class Entries {
 public:
  explicit Entries(std::string_view text) : lines_(text) {
    while (!entries_.contains("DATA")) read_line();
  }

  const Entry* find(const char* keyword) const {
    const auto found = entries_.find(keyword);
    return found == entries_.end() ? nullptr : &found->second;
  }
  const Entry& get(const char* keyword) const {
    if (const Entry* entry = find(keyword)) return *entry;
    refuse(lines_.number(), std::string("the header ends without ") + keyword);
  }
  const Lines& lines() const { return lines_; }

 private:
  void read_line() {
    auto line = lines_.next();
    if (!line) {
      throw Refusal(refusal_reason::truncated,
                    "the header ends after line " + std::to_string(lines_.number()) +
                        " without DATA; is the file cut?");
    }
    const std::string_view keyword = next_word(*line);
    if (keyword.empty() || keyword.starts_with('#')) return;
    if (!is_keyword(keyword))
      refuse(lines_.number(), in_quotes(keyword) + " is no PCD header entry");
    Entry entry{{}, lines_.number()};
    for (auto word = next_word(*line); !word.empty(); word = next_word(*line)) {
      entry.words.push_back(word);
    }
    const std::string_view key = keyword == "COLUMNS" ? "FIELDS" : keyword;
    if (!entries_.emplace(key, std::move(entry)).second) {
      refuse(lines_.number(), std::string(key) + " for the second time");
    }
  }

  static bool is_keyword(std::string_view word) {
    constexpr std::string_view keywords[] = {"VERSION",
                                             "FIELDS",
                                             "COLUMNS",
                                             "SIZE",
                                             "TYPE",
                                             "COUNT",
                                             "WIDTH",
                                             "HEIGHT",
                                             "VIEWPOINT",
                                             "POINTS",
                                             "DATA"};
    return std::ranges::find(keywords, word) != std::end(keywords);
  }

  Lines lines_;
  std::map<std::string_view, Entry> entries_;
};

std::uint64_t whole_number(std::string_view word, std::size_t line, const char* what) {
  std::uint64_t value = 0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || stop != end) {
    refuse(line, in_quotes(word) + " is no valid " + what);
  }
  return value;
}

std::uint64_t single_number(const Entry& entry, const char* keyword) {
  if (entry.words.size() != 1) refuse(entry.line, std::string(keyword) + " needs one number");
  return whole_number(entry.words[0], entry.line, keyword);
}

ScalarType scalar_type(std::string_view type, std::uint64_t size, std::size_t line) {
  struct Known {
    std::string_view type;
    std::uint64_t size;
    ScalarType scalar;
  };
  constexpr Known known[] = {{"I", 1, ScalarType::i8},
                             {"I", 2, ScalarType::i16},
                             {"I", 4, ScalarType::i32},
                             {"I", 8, ScalarType::i64},
                             {"U", 1, ScalarType::u8},
                             {"U", 2, ScalarType::u16},
                             {"U", 4, ScalarType::u32},
                             {"U", 8, ScalarType::u64},
                             {"F", 4, ScalarType::f32},
                             {"F", 8, ScalarType::f64}};
  for (const Known& k : known) {
    if (k.type == type && k.size == size) return k.scalar;
  }
  refuse(line, "there is no type " + in_quotes(type) + " of " + std::to_string(size) + " bytes");
}

void require_one_per_field(const Entry& entry, const char* keyword, std::size_t fields) {
  if (entry.words.size() == fields) return;
  refuse(entry.line,
         std::to_string(entry.words.size()) + " values in " + keyword + " but " +
             std::to_string(fields) + " names in FIELDS");
}

void read_fields(const Entries& entries, PcdHeader& header) {
  const Entry& names = entries.get("FIELDS");
  const Entry& sizes = entries.get("SIZE");
  const Entry& types = entries.get("TYPE");
  const Entry* counts = entries.find("COUNT");
  require_one_per_field(sizes, "SIZE", names.words.size());
  require_one_per_field(types, "TYPE", names.words.size());
  if (counts != nullptr) require_one_per_field(*counts, "COUNT", names.words.size());

  for (std::size_t i = 0; i < names.words.size(); ++i) {
    RecordField field;
    field.name = std::string(names.words[i]);
    const std::uint64_t size = whole_number(sizes.words[i], sizes.line, "SIZE");
    field.type = scalar_type(types.words[i], size, types.line);
    const std::uint64_t count =
        counts != nullptr ? whole_number(counts->words[i], counts->line, "COUNT") : 1;
    if (count == 0 || count > max_stride) {
      refuse(counts->line,
             "COUNT of " + field.name + " must lie in 1.." + std::to_string(max_stride));
    }
    field.count = count;
    field.offset = header.stride;
    header.stride += size * count;
    if (header.stride > max_stride) refuse(names.line, "a point of more than 1 MiB is damage");
    header.fields.push_back(std::move(field));
  }
  if (header.fields.empty()) refuse(names.line, "no FIELDS");
  for (RecordField& field : header.fields) field.stride = header.stride;
}

std::size_t read_point_count(const Entries& entries) {
  const Entry* width = entries.find("WIDTH");
  const Entry* height = entries.find("HEIGHT");
  const Entry* points = entries.find("POINTS");
  if (width == nullptr && points == nullptr) entries.get("POINTS");
  if (width == nullptr) return single_number(*points, "POINTS");
  const std::uint64_t columns = single_number(*width, "WIDTH");
  const std::uint64_t rows = height != nullptr ? single_number(*height, "HEIGHT") : 1;
  std::uint64_t product = 0;
  if (__builtin_mul_overflow(columns, rows, &product)) refuse(width->line, "WIDTH is too large");
  if (points != nullptr && single_number(*points, "POINTS") != product) {
    refuse(points->line,
           "POINTS is " + in_quotes(points->words[0]) + " but WIDTH x HEIGHT is " +
               std::to_string(product));
  }
  return product;
}

PcdEncoding read_encoding(const Entry& data) {
  const std::string_view name = data.words.size() == 1 ? data.words[0] : std::string_view();
  if (name == "ascii") return PcdEncoding::ascii;
  if (name == "binary") return PcdEncoding::binary;
  if (name == "binary_compressed") return PcdEncoding::binary_compressed;
  refuse(data.line, "DATA is " + in_quotes(name) + ", not ascii, binary or binary_compressed");
}

}  // namespace

PcdHeader read_pcd_header(std::span<const std::byte> file) {
  const Entries entries(text_of(file));
  PcdHeader header;
  read_fields(entries, header);
  header.points = read_point_count(entries);
  header.encoding = read_encoding(entries.get("DATA"));
  header.size = entries.lines().position();
  header.lines = entries.lines().number();
  return header;
}

}  // namespace kissmap
