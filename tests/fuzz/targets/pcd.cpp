// SPDX-License-Identifier: MIT
#include "formats/clouds/pcd.hpp"

#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET(pcd) {
  try {
    require_consistent(ScanDecoder({}).decode(read_pcd(input), 1'700'000'000'000'000'000));
  } catch (const Refusal&) {
    // Refusing is an answer; crashing, hanging or an inconsistent scan is not.
  }
}
