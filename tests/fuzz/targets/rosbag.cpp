// SPDX-License-Identifier: MIT
#include "formats/containers/ros1_bag.hpp"
#include "fuzz/container.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET(rosbag) {
  read_container(input, open_ros1_bag);
}
