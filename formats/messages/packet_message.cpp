// SPDX-License-Identifier: MIT
#include "formats/messages/packet_message.hpp"

#include <algorithm>

#include "formats/messages/message_reader.hpp"

namespace kissmap {
namespace {

using Take = std::function<void(std::span<const std::byte>, std::int64_t)>;

constexpr std::size_t velodyne_size = 1206;
constexpr std::size_t pandar_size = 1500;

// The stamp of a packet, which some drivers leave empty.
std::int64_t stamp_of(MessageReader& reader, std::int64_t received_ns) {
  const std::int64_t stamp_ns = read_time(reader);
  return stamp_ns == 0 ? received_ns : stamp_ns;
}

void read_velodyne_scan(MessageReader& reader, std::int64_t received_ns, const Take& take) {
  for (std::uint32_t left = reader.length(8 + velodyne_size); left > 0; --left) {
    const std::int64_t stamp_ns = stamp_of(reader, received_ns);
    take(reader.take(velodyne_size), stamp_ns);
  }
}

// A field of fixed size, of which the packet is the beginning.
void read_pandar_scan(MessageReader& reader, std::int64_t received_ns, const Take& take) {
  for (std::uint32_t left = reader.length(8 + pandar_size); left > 0; --left) {
    const std::int64_t stamp_ns = stamp_of(reader, received_ns);
    const auto field = reader.take(pandar_size);
    const std::size_t size = reader.value<std::uint32_t>();
    take(field.first(std::min(size, field.size())), stamp_ns);
  }
}

void read_sized_packets(MessageReader& reader,
                        bool with_size,
                        std::int64_t received_ns,
                        const Take& take) {
  for (std::uint32_t left = reader.length(12); left > 0; --left) {
    const std::int64_t stamp_ns = stamp_of(reader, received_ns);
    const auto packet = reader.bytes();
    const std::size_t size = with_size ? reader.value<std::uint32_t>() : packet.size();
    take(packet.first(std::min(size, packet.size())), stamp_ns);
  }
}

}  // namespace

std::optional<SensorFamily> packet_family(const Topic& topic) {
  if (topic.encoding != MessageEncoding::ros1 && topic.encoding != MessageEncoding::cdr) {
    return std::nullopt;
  }
  const std::string& type = topic.type;
  if (type == "velodyne_msgs/VelodyneScan") return SensorFamily::velodyne;
  if (type == "pandar_msgs/PandarScan" || type == "hesai_lidar/PandarScan" ||
      type == "hesai_ros_driver/UdpFrame" || type == "nebula_msgs/NebulaPackets") {
    return SensorFamily::hesai;
  }
  // Packets of the inertial sensor have the same type.
  const bool inertial = topic.name.find("imu") != std::string::npos;
  if (type.ends_with("/PacketMsg") && !inertial) return SensorFamily::ouster;
  return std::nullopt;
}

void for_each_packet(const Message& message, const Topic& topic, const Take& take) {
  MessageReader reader(message.data, topic.encoding);
  if (topic.type.ends_with("/PacketMsg")) {
    take(reader.bytes(), message.received_ns);
    return;
  }
  read_header(reader);
  if (topic.type == "velodyne_msgs/VelodyneScan") {
    read_velodyne_scan(reader, message.received_ns, take);
  } else if (topic.type == "pandar_msgs/PandarScan") {
    read_pandar_scan(reader, message.received_ns, take);
  } else {
    read_sized_packets(
        reader, topic.type != "nebula_msgs/NebulaPackets", message.received_ns, take);
  }
}

}  // namespace kissmap
