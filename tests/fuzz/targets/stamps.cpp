// SPDX-License-Identifier: MIT
#include "formats/text/stamps.hpp"

#include <cstdlib>

#include "formats/text/lines.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET(stamps) {
  const std::string_view text = text_of(input);
  nanoseconds_from_seconds(text);
  nanoseconds_from_digits(text);
  nanoseconds_from_date(text);
  stamp_in_name(text);
  const std::string_view half = text.substr(0, text.size() / 2);
  const std::string_view rest = text.substr(text.size() / 2);
  if (natural_less(half, rest) && natural_less(rest, half)) std::abort();
  if (natural_less(text, text)) std::abort();
}
