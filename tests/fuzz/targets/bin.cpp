// SPDX-License-Identifier: MIT
#include "formats/clouds/bin.hpp"

#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "fuzz/target.hpp"

// First byte: columns. Without one the width is inferred.
KISSMAP_FUZZ_TARGET(bin) {
  if (input.empty()) return;
  const auto file = input.subspan(1);
  const auto inferred = infer_bin_columns({file.size()}, file);
  const int given = min_bin_columns + std::to_integer<int>(input[0]) % (max_bin_columns - 2);
  const int* columns = std::get_if<int>(&inferred);
  try {
    require_consistent(ScanDecoder({}).decode(read_bin(file, columns ? *columns : given), 0));
  } catch (const Refusal&) {
    // Refusing is an answer; crashing, hanging or an inconsistent scan is not.
  }
}
