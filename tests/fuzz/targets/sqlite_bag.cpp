// SPDX-License-Identifier: MIT
#include "formats/containers/sqlite_bag.hpp"

#include "fuzz/container.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET_WITHIN(sqlite_bag, kissmap::fuzz_mebibytes_of_zstd) {
  read_container(input,
                 [](const std::filesystem::path& path) { return open_sqlite_bag(path, 32 << 20); });
}
