// SPDX-License-Identifier: MIT
#pragma once

#include <sstream>
#include <string>

#include "kissmap/error.hpp"

namespace kissmap {

/// Throws Error(usage) naming the option, its value and its range. NaN is out of every range.
inline void require_between(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  std::ostringstream message;
  message << name << " = " << value << " is outside " << low << ".." << high;
  throw usage_error(message.str());
}

}  // namespace kissmap
