// SPDX-License-Identifier: MIT
// The first byte chooses between NumPy arrays, text and LAS.
#include "formats/clouds/las_reader.hpp"
#include "formats/clouds/npy.hpp"
#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "formats/clouds/text_cloud.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET(other_clouds) {
  if (input.empty()) return;
  const auto file = input.subspan(1);
  try {
    const unsigned choice = std::to_integer<unsigned>(input[0]) % 3;
    const PointRecords records = choice == 0   ? read_npy(file)
                                 : choice == 1 ? read_text_cloud(file)
                                               : read_las(file);
    require_consistent(ScanDecoder({}).decode(records, 1'700'000'000'000'000'000));
  } catch (const Refusal&) {
    // Refusing is an answer; crashing, hanging or an inconsistent scan is not.
  }
}
