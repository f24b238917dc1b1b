// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace kissmap::test {

/// The largest block asked of operator new since the last forget_allocations(); always 0 where a
/// sanitizer owns the operator.
std::size_t largest_allocation();
void forget_allocations();

}  // namespace kissmap::test
