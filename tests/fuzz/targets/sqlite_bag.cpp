// SPDX-License-Identifier: MIT
#include "formats/containers/sqlite_bag.hpp"

#include "formats/text/lines.hpp"
#include "fuzz/container.hpp"
#include "fuzz/folder.hpp"
#include "fuzz/target.hpp"

namespace kissmap {
namespace {

// SQLite follows links, and finds nothing behind that of a file which has no name.
const FuzzFolder& folder() {
  static const FuzzFolder made;
  return made;
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET_WITHIN(sqlite_bag, kissmap::fuzz_mebibytes_of_zstd) {
  folder().write("bag.db3", text_of(input));
  read_messages([] { return open_sqlite_bag(folder().path() / "bag.db3", 32 << 20); });
}
