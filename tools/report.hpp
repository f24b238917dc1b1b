// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "kissmap/formats/session.hpp"

namespace kissmap {

/// "1234567" -> "1,234,567"
std::string with_commas(std::uint64_t value);

/// printf for strings.
[[gnu::format(printf, 1, 2)]] std::string text(const char* pattern, ...);

/// File names come from anywhere; control characters in them must not reach a terminal.
std::string printable(std::string text, bool keep_lines = false);

/// What was left out of a run and why, a line each, indented; empty if nothing was.
std::string describe_refusals(const SessionCounts& counts);

/// How many of the candidates became closures, a line.
std::string describe_loops(const std::vector<Closure>& closures);

/// "2.4 bytes/point" and so on.
std::string describe(const PackSummary& pack);

}  // namespace kissmap
