// SPDX-License-Identifier: MIT
// For programs with AddressSanitizer.
#pragma once

#include <sanitizer/allocator_interface.h>
#include <sanitizer/common_interface_defs.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace kissmap {

/// While it lives, a larger block asked of malloc or operator new ends the program.
class AllocationLimit {
 public:
  explicit AllocationLimit(std::size_t bytes) {
    static const bool installed =
        __sanitizer_install_malloc_and_free_hooks(check, [](const volatile void*) {}) != 0;
    if (!installed) std::abort();
    most_bytes = bytes;
  }
  ~AllocationLimit() { most_bytes = SIZE_MAX; }
  AllocationLimit(const AllocationLimit&) = delete;
  AllocationLimit& operator=(const AllocationLimit&) = delete;

 private:
  static void check(const volatile void*, std::size_t size) {
    const std::size_t most = most_bytes;
    if (size <= most) return;
    most_bytes = SIZE_MAX;  // what follows may allocate
    std::fprintf(stderr, "ERROR: a block of %zu bytes, more than %zu\n", size, most);
    __sanitizer_print_stack_trace();
    std::abort();
  }

  static inline std::atomic<std::size_t> most_bytes{SIZE_MAX};
};

}  // namespace kissmap
