// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

/// KISSMAP_FUZZ_TARGET(name) { ... uses `input` ... } defines fuzz_name(input), which has to return
/// for any bytes. Fuzzer builds make it libFuzzer's entry; the test of stored crashes calls it.
#define KISSMAP_FUZZ_TARGET(name)                     \
  namespace kissmap {                                 \
  void fuzz_##name(std::span<const std::byte> input); \
  }                                                   \
  KISSMAP_FUZZ_ENTRY(name)                            \
  void kissmap::fuzz_##name([[maybe_unused]] std::span<const std::byte> input)

#ifdef KISSMAP_LIBFUZZER
#define KISSMAP_FUZZ_ENTRY(name)                                                      \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    kissmap::fuzz_##name(std::as_bytes(std::span(data, size)));                       \
    return 0;                                                                         \
  }
#else
#define KISSMAP_FUZZ_ENTRY(name)
#endif
