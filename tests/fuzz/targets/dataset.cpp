// SPDX-License-Identifier: MIT
// The first byte chooses a data set; the rest becomes a scan or a table in a folder of its layout.
#include <array>
#include <cstdlib>

#include "formats/text/lines.hpp"
#include "fuzz/folder.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/registry.hpp"

namespace kissmap {
namespace {

/// Where the bytes go, and what stands beside them.
struct Layout {
  const char* format;
  const char* log;   ///< folder or file that is opened
  const char* file;  ///< holds the input
  const char* beside;
  const char* beside_content;
};
constexpr std::array<Layout, 15> layouts{{
    {"mulran", "mulran", "mulran/Ouster/1561000444390857630.bin", "mulran/global_pose.csv", ""},
    {"helipr", "ouster", "ouster/LiDAR/Ouster/1689519045.bin", "ouster/readme", ""},
    {"helipr", "velodyne", "velodyne/LiDAR/Velodyne/1689519045.bin", "velodyne/readme", ""},
    {"helipr", "avia", "avia/LiDAR/Avia/1689519045.bin", "avia/readme", ""},
    {"helipr", "aeva", "aeva/LiDAR/Aeva/1689519045.bin", "aeva/readme", ""},
    {"nclt", "nclt", "nclt/velodyne_sync/1326030975726043.bin", "nclt/readme", ""},
    {"nclt-hits", "hits/velodyne_hits.bin", "hits/velodyne_hits.bin", "hits/readme", ""},
    {"boreas", "boreas", "boreas/lidar/1606417097528152.bin", "boreas/calib/readme", ""},
    {"boreas", "boreas_rt", "boreas_rt/aeva/1606417097528152.bin", "boreas_rt/calib/readme", ""},
    {"paris-luco", "luco", "luco/frames/frame_00000.ply", "luco/gt_traj_lidar.txt", "0 0 0\n"},
    {"newer-college", "ncd", "ncd/raw_format/ouster_scan/cloud_1583836591_5.pcd", "ncd/readme", ""},
    {"apollo", "apollo", "apollo/poses/gt_poses.txt", "apollo/pcds/1.pcd", "VERSION .7\n"},
    {"nuscenes", "scene", "scene/v1.0-mini/scene.json", "scene/v1.0-mini/sample_data.json", "[]"},
    {"nuscenes",
     "data",
     "data/v1.0-mini/sample_data.json",
     "data/v1.0-mini/scene.json",
     R"([{"name": "scene-0061", "first_sample_token": "s1"}])"},
    {"kitti", "sequences/00", "sequences/00/calib.txt", "sequences/00/velodyne/000000.bin", ""},
}};

const FuzzFolder& folder() {
  static const FuzzFolder made;
  static const bool written = [] {
    for (const Layout& layout : layouts) {
      made.write(layout.file, "");
      made.write(layout.beside, layout.beside_content);
    }
    return true;
  }();
  if (!written) std::abort();
  return made;
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET(dataset) {
  if (input.empty()) return;
  const Layout& layout = layouts[std::to_integer<std::size_t>(input[0]) % layouts.size()];
  folder().write(layout.file, text_of(input.subspan(1)));
  try {
    const auto log = open_log(folder().path() / layout.log, {}, layout.format);
    while (const auto entry = log->next()) {
      if (const auto* scan = std::get_if<Scan>(&entry->content)) require_consistent(*scan);
    }
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
}
