// SPDX-License-Identifier: MIT
#include <cstdlib>

#include "formats/session/pack_log.hpp"
#include "fuzz/input_file.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"

KISSMAP_FUZZ_TARGET(pack) {
  const FuzzInputFile file(input);
  try {
    const auto log = open_packed(file.path(), {});
    while (const auto entry = log->next()) {
      if (const auto* scan = std::get_if<Scan>(&entry->content)) require_consistent(*scan);
    }
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
}
