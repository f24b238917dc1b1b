// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace kissmap {

/// Nanoseconds of a decimal number of seconds, exact to the nanosecond for any number of digits;
/// an exponent is allowed. Nothing if it is no number or does not fit into 64 bits.
std::optional<std::int64_t> nanoseconds_from_seconds(std::string_view text);

/// Nanoseconds of a whole number whose unit its digits tell: 10 seconds, 13 ms, 16 us, 19 ns since
/// 1970. Nothing for any other number of digits or with leading zeros.
std::optional<std::int64_t> nanoseconds_from_digits(std::string_view text);

/// The stamp in the name of a file without its extension: behind an optional prefix that ends in
/// something else than a digit, digits as above, or <seconds>_<nanoseconds> with or without
/// leading zeros in the nanoseconds, or <seconds>.<fraction>.
std::optional<std::int64_t> stamp_in_name(std::string_view stem);

/// Nanoseconds since 1970 of "YYYY-MM-DD HH:MM:SS[.fraction]", read as UTC.
std::optional<std::int64_t> nanoseconds_from_date(std::string_view text);

/// Whether name a comes before b when runs of digits are compared as numbers.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace kissmap
