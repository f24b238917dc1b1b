// SPDX-License-Identifier: MIT
#include "formats/containers/mcap.hpp"

#include "fuzz/container.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET_WITHIN(mcap, kissmap::fuzz_mebibytes_of_zstd) {
  read_container(input, open_mcap);
}
