// SPDX-License-Identifier: MIT
#include "formats/messages/cloud_message.hpp"

#include <algorithm>

#include "formats/clouds/refusal.hpp"

namespace kissmap {
namespace {

enum class CloudType : std::uint8_t { none, point_cloud2, livox_custom, foxglove };

CloudType cloud_type(const Topic& topic) {
  const bool ros =
      topic.encoding == MessageEncoding::ros1 || topic.encoding == MessageEncoding::cdr;
  if (ros && topic.type == "sensor_msgs/PointCloud2") return CloudType::point_cloud2;
  if (ros && topic.type.starts_with("livox") && topic.type.ends_with("/CustomMsg")) {
    return CloudType::livox_custom;
  }
  if (topic.encoding == MessageEncoding::protobuf && topic.type == "foxglove.PointCloud") {
    return CloudType::foxglove;
  }
  return CloudType::none;
}

}  // namespace

bool is_cloud_type(const Topic& topic) {
  return cloud_type(topic) != CloudType::none;
}

CloudMessage read_cloud_message(std::span<const std::byte> message, const Topic& topic) {
  switch (cloud_type(topic)) {
    case CloudType::point_cloud2:
      return read_point_cloud2(message, topic.encoding);
    case CloudType::livox_custom:
      return read_livox_custom(message, topic.encoding);
    case CloudType::foxglove:
      return read_foxglove_cloud(message);
    case CloudType::none:
      break;
  }
  throw Refusal(refusal_reason::unsupported, "messages of type " + topic.type + " hold no cloud");
}

}  // namespace kissmap
