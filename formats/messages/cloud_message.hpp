// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "formats/clouds/record_layout.hpp"
#include "formats/containers/message_source.hpp"

namespace kissmap {

/// A cloud as a message holds it. `records.bytes` may point into the message.
struct CloudMessage {
  std::int64_t stamp_ns = 0;  ///< of the header; 0 where the driver left it empty
  std::string frame;
  PointRecords records;
  /// Where the cloud's frame lies in the frame named; none if they are the same.
  std::optional<Eigen::Isometry3d> frame_from_points;
};

/// True for the types read_cloud_message reads.
bool is_cloud_type(const Topic& topic);

/// sensor_msgs/PointCloud2, Livox CustomMsg and foxglove.PointCloud. Throws Refusal.
CloudMessage read_cloud_message(std::span<const std::byte> message, const Topic& topic);

/// sensor_msgs/PointCloud2 of ROS 1 and 2 (docs.ros.org, common_interfaces).
CloudMessage read_point_cloud2(std::span<const std::byte> message, MessageEncoding encoding);

/// CustomMsg of livox_ros_driver and livox_ros_driver2 (their msg folders).
CloudMessage read_livox_custom(std::span<const std::byte> message, MessageEncoding encoding);

/// foxglove.PointCloud in protobuf (foxglove/schemas, PointCloud.proto, PackedElementField.proto;
/// protobuf.dev/programming-guides/encoding).
CloudMessage read_foxglove_cloud(std::span<const std::byte> message);

}  // namespace kissmap
