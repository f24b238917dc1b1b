// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

/// Parses one number of text as `type`, independent of locale, and appends its bytes in native
/// order. False if it is no such number; float fields take nan and inf.
bool append_number(std::string_view word, ScalarType type, std::vector<std::byte>& out);

/// Reads one record, a line of words, in the order of `fields` (their counts included).
/// Throws Refusal naming the line and what is wrong with it.
void append_record(std::string_view line,
                   std::size_t line_number,
                   const std::vector<RecordField>& fields,
                   std::vector<std::byte>& out);

}  // namespace kissmap
