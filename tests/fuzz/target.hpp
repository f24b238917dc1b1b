// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#ifdef KISSMAP_LIBFUZZER
#include "fuzz/allocation_limit.hpp"
#endif

/// KISSMAP_FUZZ_TARGET(name) { ... uses `input` ... } defines fuzz_name(input), which has to return
/// for any bytes. Fuzzer builds make it libFuzzer's entry, and end at an allocation larger than
/// fuzz_mebibytes plus fuzz_multiple times the input; the test of stored inputs calls it, too.
#define KISSMAP_FUZZ_TARGET(name) KISSMAP_FUZZ_TARGET_WITHIN(name, kissmap::fuzz_mebibytes)

/// The same with another bound in place of fuzz_mebibytes.
#define KISSMAP_FUZZ_TARGET_WITHIN(name, mebibytes)   \
  namespace kissmap {                                 \
  void fuzz_##name(std::span<const std::byte> input); \
  }                                                   \
  KISSMAP_FUZZ_ENTRY(name, mebibytes)                 \
  void kissmap::fuzz_##name([[maybe_unused]] std::span<const std::byte> input)

namespace kissmap {

/// What one block of memory may have: columns of numbers made of one byte each, in vectors that
/// double, and working memory that does not depend on the file.
inline constexpr std::size_t fuzz_mebibytes = 64;
inline constexpr std::size_t fuzz_multiple = 64;

/// For what zstd has packed: its frames may ask for 128 MiB to look back into.
inline constexpr std::size_t fuzz_mebibytes_of_zstd = 160;

}  // namespace kissmap

#ifdef KISSMAP_LIBFUZZER
#define KISSMAP_FUZZ_ENTRY(name, mebibytes)                                                     \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {           \
    const kissmap::AllocationLimit limit(((mebibytes) << 20U) + kissmap::fuzz_multiple * size); \
    kissmap::fuzz_##name(std::as_bytes(std::span(data, size)));                                 \
    return 0;                                                                                   \
  }
#else
#define KISSMAP_FUZZ_ENTRY(name, mebibytes)
#endif
