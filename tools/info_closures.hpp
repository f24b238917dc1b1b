// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "kissmap/formats/session.hpp"

namespace kissmap {

/// The candidates for closures by what became of them, and the closures, `most` lines of them.
std::string describe_closures(const Session& session, std::size_t most);

}  // namespace kissmap
