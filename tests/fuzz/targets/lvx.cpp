// SPDX-License-Identifier: MIT
#include "formats/logs/logs.hpp"
#include "fuzz/input_file.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"

KISSMAP_FUZZ_TARGET(lvx) {
  const FuzzInputFile file(input);
  try {
    const auto log = open_lvx(file.path(), {});
    while (const auto entry = log->next()) {
      if (const auto* scan = std::get_if<Scan>(&entry->content)) require_consistent(*scan);
    }
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
}
