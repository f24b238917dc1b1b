// SPDX-License-Identifier: MIT
#include "formats/containers/sqlite_bag.hpp"

#include "fuzz/container.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET(sqlite_bag) {
  read_container(input,
                 [](const std::filesystem::path& path) { return open_sqlite_bag(path, true); });
}
