// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "kissmap/formats/product_frame.hpp"
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

/// By its name on the command line.
ProductFrame frame_named(const std::string& name);

/// Where a product lies beside trajectory.tum, in lines; empty if in the same frame.
std::string describe_frame(ProductFrame frame, const Rigid3& frame_from_map);

/// That coordinates lack an offset, a line; empty if they lack none.
std::string describe_offset(const std::filesystem::path& offset_file);

/// How many rays without a return were believed up to `range` [m], a line; empty if it is 0.
std::string describe_no_returns(double range, std::uint64_t no_returns);

/// Of --max-memory. Throws Error(usage) for what is no size.
std::uint64_t bytes_of(double gigabytes);

/// "2.4 bytes/point" and so on.
std::string describe(const PackSummary& pack);

}  // namespace kissmap
