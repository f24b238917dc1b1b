// SPDX-License-Identifier: MIT
// A file of a ROS 2 bag packed as a whole. The first byte chooses between SQLite and MCAP.
#include <algorithm>
#include <cstdlib>

#include "formats/containers/ros2_bag.hpp"
#include "formats/text/lines.hpp"
#include "fuzz/container.hpp"
#include "fuzz/folder.hpp"
#include "fuzz/target.hpp"

namespace kissmap {
namespace {

// Four bytes of zstd may stand for 128 KiB, all of which is written to a file.
constexpr std::size_t most_bytes = 4096;

const FuzzFolder& folder() {
  static const FuzzFolder made;
  static const bool there = ::setenv("TMPDIR", made.path().c_str(), 1) == 0;
  if (!there) std::abort();
  return made;
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET_WITHIN(packed_bag, kissmap::fuzz_mebibytes_of_zstd) {
  if (input.empty()) return;
  const bool mcap = std::to_integer<unsigned>(input[0]) % 2 == 1;
  const char* name = mcap ? "bag.mcap.zstd" : "bag.db3.zstd";
  const auto content = input.subspan(1);
  folder().write(name, text_of(content.first(std::min(content.size(), most_bytes))));
  read_messages([&] { return open_ros2_bag(folder().path() / name); });
}
