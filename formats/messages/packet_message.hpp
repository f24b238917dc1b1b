// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "formats/containers/message_source.hpp"
#include "formats/sensors/packet_decoder.hpp"

namespace kissmap {

/// Whose data packets a topic holds, if any.
std::optional<SensorFamily> packet_family(const Topic& topic);

/// Calls `take` with each packet of a message and the time at which it was received [ns]:
/// velodyne_msgs/VelodyneScan, pandar_msgs/PandarScan (Autoware), hesai_lidar/PandarScan,
/// hesai_ros_driver/UdpFrame, nebula_msgs/NebulaPackets, PacketMsg of the Ouster drivers. Layouts:
/// the msg folders of these drivers. Throws Refusal.
void for_each_packet(const Message& message,
                     const Topic& topic,
                     const std::function<void(std::span<const std::byte>, std::int64_t)>& take);

}  // namespace kissmap
