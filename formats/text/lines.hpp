// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kissmap {

/// Bytes of a file seen as text. The bytes must outlive the view.
inline std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

constexpr bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes the next word off the front of `text`; empty at the end.
inline std::string_view next_word(std::string_view& text) {
  std::size_t begin = 0;
  while (begin < text.size() && is_space(text[begin])) ++begin;
  std::size_t end = begin;
  while (end < text.size() && !is_space(text[end])) ++end;
  const std::string_view word = text.substr(begin, end - begin);
  text.remove_prefix(end);
  return word;
}

/// Walks through text line by line. Lines come without their end, be it LF or CR LF.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text) {}

  std::optional<std::string_view> next() {
    if (position_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', position_), text_.size());
    std::string_view line = text_.substr(position_, end - position_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    position_ = std::min(end + 1, text_.size());
    ++number_;
    return line;
  }
  std::optional<std::string_view> next_not_blank() {
    auto line = next();
    while (line && trimmed(*line).empty()) line = next();
    return line;
  }

  std::size_t number() const { return number_; }      ///< of the line taken last, from 1
  std::size_t position() const { return position_; }  ///< byte behind the line taken last

 private:
  std::string_view text_;
  std::size_t position_ = 0;
  std::size_t number_ = 0;
};

/// A piece of foreign text for an error message: short and printable.
inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t max_length = 40;
  std::string result = "'";
  for (const char c : text.substr(0, max_length)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > max_length ? "...'" : "'");
}

}  // namespace kissmap
