// SPDX-License-Identifier: MIT
// The input is the metadata.yaml of a folder with two files.
#include "formats/containers/ros2_bag.hpp"
#include "formats/conversion/mcap_writer.hpp"
#include "formats/text/lines.hpp"
#include "fuzz/container.hpp"
#include "fuzz/folder.hpp"
#include "fuzz/target.hpp"

namespace kissmap {
namespace {

const FuzzFolder& folder() {
  static const FuzzFolder made;
  static const bool written = [] {
    for (const char* name : {"bag_0.mcap", "bag_1.mcap"}) {
      McapWriter writer(made.path() / name,
                        {"/points", "std_msgs/msg/String", "ros2msg", "", "cdr", "ros2"});
      writer.add(1'700'000'000'000'000'000, "message");
      writer.finish();
    }
    return true;
  }();
  if (!written) std::abort();
  return made;
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET(ros2_folder) {
  folder().write("metadata.yaml", text_of(input));
  read_messages([] { return open_ros2_bag(folder().path()); });
}
