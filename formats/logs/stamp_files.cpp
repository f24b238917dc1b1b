// SPDX-License-Identifier: MIT
#include "formats/logs/stamp_files.hpp"

#include <cstddef>
#include <string_view>

#include "formats/files/input_file.hpp"
#include "formats/files/xxh3.hpp"
#include "formats/text/lines.hpp"
#include "formats/text/stamps.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using ParseStamp = std::optional<std::int64_t> (*)(std::string_view);

std::optional<std::int64_t> stamp_from_number(std::string_view text) {
  const auto of_digits = text.size() > 10 ? nanoseconds_from_digits(text) : std::nullopt;
  return of_digits ? of_digits : nanoseconds_from_seconds(text);
}

StampFile read_stamps(const std::filesystem::path& path,
                      const std::string& name,
                      ParseStamp parse) {
  const std::vector<std::byte> bytes = read_side_file(path);
  StampFile result{{}, {name, bytes.size(), xxh3_hex(bytes)}};
  Lines lines(text_of(bytes));
  while (const auto line = lines.next()) {
    const std::string_view text = trimmed(*line);
    if (text.starts_with('#')) continue;
    const auto stamp = text.empty() ? std::nullopt : parse(text);
    if (!stamp && !text.empty()) {
      throw input_error(
          path, "line " + std::to_string(lines.number()) + ": " + in_quotes(text) + " is no stamp");
    }
    result.stamps_ns.push_back(stamp);
  }
  return result;
}

}  // namespace

StampFile read_number_stamps(const std::filesystem::path& path, const std::string& name) {
  StampFile file = read_stamps(path, name, stamp_from_number);
  while (!file.stamps_ns.empty() && !file.stamps_ns.back()) file.stamps_ns.pop_back();
  for (std::size_t i = 0; i < file.stamps_ns.size(); ++i) {
    if (file.stamps_ns[i]) continue;
    throw input_error(path,
                      "stamp " + std::to_string(i + 1) +
                          " is a blank line; each scan needs "
                          "one, remove the line or fill it in");
  }
  return file;
}

StampFile read_date_stamps(const std::filesystem::path& path, const std::string& name) {
  return read_stamps(path, name, nanoseconds_from_date);
}

}  // namespace kissmap
