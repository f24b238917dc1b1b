// SPDX-License-Identifier: MIT
// The first byte chooses the type of the message.
#include "formats/messages/cloud_message.hpp"

#include <array>

#include "formats/clouds/refusal.hpp"
#include "formats/clouds/scan_decoder.hpp"
#include "fuzz/target.hpp"

KISSMAP_FUZZ_TARGET(cloud_message) {
  static const std::array topics{
      Topic{"/a", "sensor_msgs/PointCloud2", MessageEncoding::ros1, std::nullopt},
      Topic{"/b", "sensor_msgs/PointCloud2", MessageEncoding::cdr, std::nullopt},
      Topic{"/c", "livox_ros_driver/CustomMsg", MessageEncoding::ros1, std::nullopt},
      Topic{"/d", "livox_ros_driver2/CustomMsg", MessageEncoding::cdr, std::nullopt},
      Topic{"/e", "foxglove.PointCloud", MessageEncoding::protobuf, std::nullopt}};
  if (input.empty()) return;
  const Topic& topic = topics[std::to_integer<std::size_t>(input[0]) % topics.size()];
  try {
    const CloudMessage cloud = read_cloud_message(input.subspan(1), topic);
    require_consistent(ScanDecoder({}).decode(cloud.records, cloud.stamp_ns));
  } catch (const Refusal&) {
    // Refusing is an answer; crashing, hanging or an inconsistent scan is not.
  }
}
