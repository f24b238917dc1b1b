// SPDX-License-Identifier: MIT
#include "formats/text/stamps.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <string>

namespace kissmap {
namespace {

constexpr std::int64_t nanoseconds_per_second = 1'000'000'000;

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, is_digit);
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> scaled(std::string_view digits, std::int64_t factor) {
  const auto value = whole_number(digits);
  std::int64_t product = 0;
  if (!value || __builtin_mul_overflow(*value, factor, &product)) return std::nullopt;
  return product;
}

/// digits * 10^exponent, both as text would have it.
struct Decimal {
  std::string digits;
  std::int64_t exponent = 0;
};

std::optional<Decimal> decimal_from(std::string_view text) {
  const std::size_t e = text.find_first_of("eE");
  Decimal decimal;
  if (e != std::string_view::npos) {
    std::string_view exponent = text.substr(e + 1);
    if (exponent.starts_with('+')) exponent.remove_prefix(1);
    const auto value = whole_number(exponent);
    if (!value || *value < -1000 || *value > 1000) return std::nullopt;
    decimal.exponent = *value;
    text = text.substr(0, e);
  }
  const std::size_t dot = std::min(text.find('.'), text.size());
  decimal.digits = std::string(text.substr(0, dot));
  if (dot < text.size()) {
    decimal.digits += text.substr(dot + 1);
    decimal.exponent -= static_cast<std::int64_t>(text.size() - dot - 1);
  }
  if (!all_digits(decimal.digits)) return std::nullopt;
  return decimal;
}

// Rounds half up in its magnitude.
std::optional<std::int64_t> to_integer(Decimal decimal) {
  decimal.digits.erase(0, decimal.digits.find_first_not_of('0'));
  const auto size = static_cast<std::int64_t>(decimal.digits.size());
  if (decimal.digits.empty() || size + decimal.exponent < 0) return 0;
  if (size + decimal.exponent > 19) return std::nullopt;
  if (decimal.exponent >= 0) {
    return whole_number(decimal.digits +
                        std::string(static_cast<std::size_t>(decimal.exponent), '0'));
  }
  const auto kept = static_cast<std::size_t>(size + decimal.exponent);
  const auto value = kept == 0 ? 0 : whole_number(std::string_view(decimal.digits).substr(0, kept));
  const std::int64_t up = decimal.digits[kept] >= '5' ? 1 : 0;
  std::int64_t rounded = 0;
  if (!value || __builtin_add_overflow(*value, up, &rounded)) return std::nullopt;
  return rounded;
}

std::size_t digits_at_end(std::string_view text) {
  const auto last_other = std::ranges::find_if_not(text.rbegin(), text.rend(), is_digit);
  return static_cast<std::size_t>(last_other - text.rbegin());
}

/// Two numbers at the end of a name, with one character between them.
struct NumberPair {
  std::string_view first;
  char separator;
  std::string_view second;
  std::string_view both;  ///< with the separator
};

std::optional<NumberPair> pair_at_end(std::string_view stem) {
  const std::size_t second = digits_at_end(stem);
  if (second == 0 || second == stem.size()) return std::nullopt;
  const std::string_view before = stem.substr(0, stem.size() - second - 1);
  const std::size_t first = digits_at_end(before);
  if (first == 0) return std::nullopt;
  return NumberPair{before.substr(before.size() - first),
                    stem[before.size()],
                    stem.substr(stem.size() - second),
                    stem.substr(before.size() - first)};
}

// Ten or nine digits are seconds since 1970; with fewer only a full fraction makes it a time, for
// "07_000123" may be anything.
bool looks_like_seconds_and_nanoseconds(const NumberPair& pair) {
  if (pair.separator != '_' || pair.second.size() > 9 || pair.first.size() > 10) return false;
  return pair.first.size() >= 9 || pair.second.size() == 9;
}

std::optional<std::int64_t> stamp_from_pair(const NumberPair& pair) {
  if (looks_like_seconds_and_nanoseconds(pair)) {
    std::int64_t stamp = 0;
    const auto whole = scaled(pair.first, nanoseconds_per_second);
    const bool overflow =
        !whole || __builtin_add_overflow(*whole, *whole_number(pair.second), &stamp);
    return overflow ? std::nullopt : std::optional(stamp);
  }
  if (pair.separator != '.') return std::nullopt;
  return nanoseconds_from_seconds(pair.both);
}

}  // namespace

std::optional<std::int64_t> nanoseconds_from_seconds(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  auto decimal = decimal_from(text);
  if (!decimal) return std::nullopt;
  decimal->exponent += 9;
  const auto magnitude = to_integer(*decimal);
  if (!magnitude) return std::nullopt;
  return negative ? -*magnitude : *magnitude;
}

std::optional<std::int64_t> nanoseconds_from_digits(std::string_view text) {
  if (!all_digits(text) || text.front() == '0') return std::nullopt;
  switch (text.size()) {
    case 10:
      return scaled(text, nanoseconds_per_second);
    case 13:
      return scaled(text, 1'000'000);
    case 16:
      return scaled(text, 1'000);
    case 19:
      return scaled(text, 1);
    default:
      return std::nullopt;
  }
}

std::optional<std::int64_t> stamp_in_name(std::string_view stem) {
  if (const auto pair = pair_at_end(stem)) {
    if (const auto stamp = stamp_from_pair(*pair)) return stamp;
  }
  return nanoseconds_from_digits(stem.substr(stem.size() - digits_at_end(stem)));
}

std::optional<std::int64_t> nanoseconds_from_date(std::string_view text) {
  constexpr std::string_view shape = "dddd-dd-dd dd:dd:dd";
  if (text.size() < shape.size()) return std::nullopt;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const bool matches = shape[i] == 'd' ? is_digit(text[i]) : text[i] == shape[i];
    if (!matches) return std::nullopt;
  }
  const auto number = [&](std::size_t begin, std::size_t size) {
    return static_cast<int>(*whole_number(text.substr(begin, size)));
  };
  using namespace std::chrono;
  const year_month_day date{year(number(0, 4)),
                            month(static_cast<unsigned>(number(5, 2))),
                            day(static_cast<unsigned>(number(8, 2)))};
  if (!date.ok() || number(0, 4) < 1970 || number(0, 4) > 2200) return std::nullopt;
  if (number(11, 2) > 23 || number(14, 2) > 59 || number(17, 2) > 60) return std::nullopt;
  const sys_seconds instant = sys_seconds(sys_days(date)) + hours(number(11, 2)) +
                              minutes(number(14, 2)) + std::chrono::seconds(number(17, 2));
  const auto seconds = instant.time_since_epoch().count();
  const std::string_view fraction = text.substr(shape.size());
  if (!fraction.empty() && !fraction.starts_with('.')) return std::nullopt;
  const bool has_digits = fraction.size() > 1;
  // Digits alone: with an exponent it would be no fraction of a second.
  if (has_digits && !all_digits(fraction.substr(1))) return std::nullopt;
  const auto ns = has_digits ? nanoseconds_from_seconds(fraction) : 0;
  if (!ns) return std::nullopt;
  return seconds * nanoseconds_per_second + *ns;
}

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
      continue;
    }
    const auto run = [](std::string_view text, std::size_t& at) {
      while (at < text.size() && text[at] == '0') ++at;
      const std::size_t begin = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return text.substr(begin, at - begin);
    };
    const std::string_view x = run(a, i);
    const std::string_view y = run(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  if (i < a.size() || j < b.size()) return i >= a.size();
  return a < b;
}

}  // namespace kissmap
