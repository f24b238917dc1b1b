// SPDX-License-Identifier: MIT
// Tables of stamps beside scans. The first byte chooses the layout; of KITTI's raw data the parts
// between zero bytes become timestamps.txt, timestamps_start.txt and timestamps_end.txt.
#include <array>
#include <cstdlib>
#include <filesystem>

#include "formats/text/lines.hpp"
#include "fuzz/folder.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/registry.hpp"

namespace kissmap {
namespace {

struct Layout {
  const char* format;
  const char* log;
  std::array<const char*, 2> scans;
  std::array<const char*, 3> tables;
};
constexpr std::array<Layout, 3> layouts{{
    {"kitti",
     "sequences/00",
     {"sequences/00/velodyne/000000.bin", "sequences/00/velodyne/000001.bin"},
     {"sequences/00/times.txt"}},
    {"folder", "plain", {"plain/scan1.bin", "plain/scan2.bin"}, {"plain/times.txt"}},
    {"kitti-raw",
     "raw",
     {"raw/velodyne_points/data/0000000000.bin", "raw/velodyne_points/data/0000000002.bin"},
     {"raw/velodyne_points/timestamps.txt",
      "raw/velodyne_points/timestamps_start.txt",
      "raw/velodyne_points/timestamps_end.txt"}},
}};

const FuzzFolder& folder() {
  static const FuzzFolder made;
  static const bool written = [] {
    const std::string ones{"\0\0\x80\x3f", 4};
    for (const Layout& layout : layouts) {
      for (const char* scan : layout.scans) made.write(scan, ones + ones + ones + ones);
    }
    return true;
  }();
  if (!written) std::abort();
  return made;
}

void write_tables(const Layout& layout, std::string_view text) {
  for (const char* table : layout.tables) {
    if (table == nullptr) return;
    const bool alone = layout.tables[1] == nullptr;
    const std::size_t end = alone ? text.size() : std::min(text.find('\0'), text.size());
    folder().write(table, text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET(stamp_tables) {
  if (input.empty()) return;
  const Layout& layout = layouts[std::to_integer<std::size_t>(input[0]) % layouts.size()];
  write_tables(layout, text_of(input.subspan(1)));
  try {
    const auto log = open_log(folder().path() / layout.log, {}, layout.format);
    log->known_times();
    while (const auto entry = log->next()) {
      if (const auto* scan = std::get_if<Scan>(&entry->content)) require_consistent(*scan);
    }
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
}
