// SPDX-License-Identifier: MIT
#include "fuzz/input_file.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/graph_edits.hpp"

KISSMAP_FUZZ_TARGET(edits) {
  const FuzzInputFile file(input);
  try {
    read_graph_edits(file.path());
  } catch (const Error&) {
    // Refusing is an answer; crashing or hanging is not.
  }
}
