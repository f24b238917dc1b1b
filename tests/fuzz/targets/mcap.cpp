// SPDX-License-Identifier: MIT
#include "formats/containers/mcap.hpp"

#include "fuzz/container.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET(mcap) {
  read_container(input, open_mcap);
}
