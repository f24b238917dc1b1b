// SPDX-License-Identifier: MIT
// Messages of sensors' drivers. The first byte chooses their type; each follows behind its length
// of 16 bits, the highest of which makes it the metadata of an Ouster.
#include <array>
#include <cstdlib>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/byte_cursor.hpp"
#include "formats/logs/sweep_maker.hpp"
#include "formats/text/lines.hpp"
#include "fuzz/ouster_json.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr auto ros1 = MessageEncoding::ros1;
constexpr auto cdr = MessageEncoding::cdr;

const std::array topics{
    Topic{"/velodyne_packets", "velodyne_msgs/VelodyneScan", ros1, std::nullopt},
    Topic{"/velodyne_packets", "velodyne_msgs/VelodyneScan", cdr, std::nullopt},
    Topic{"/pandar_packets", "pandar_msgs/PandarScan", ros1, std::nullopt},
    Topic{"/pandar_packets", "pandar_msgs/PandarScan", cdr, std::nullopt},
    Topic{"/pandar_packets", "hesai_lidar/PandarScan", ros1, std::nullopt},
    Topic{"/lidar_packets", "hesai_ros_driver/UdpFrame", cdr, std::nullopt},
    Topic{"/nebula_packets", "nebula_msgs/NebulaPackets", cdr, std::nullopt},
    Topic{"/os_node/lidar_packets", "ouster_ros/PacketMsg", ros1, std::nullopt},
    Topic{"/ouster/lidar_packets", "ouster_sensor_msgs/PacketMsg", cdr, std::nullopt}};

constexpr unsigned known_metadata = 0x80;  // of the first byte
constexpr unsigned is_metadata = 0x8000;   // of a length

void take_all(SweepMaker& maker) {
  while (const auto scan = maker.take()) require_consistent(*scan);
}

void add(SweepMaker& maker, std::span<const std::byte> data, const Topic& topic) {
  try {
    maker.add({0, 1'700'000'000'000'000'000, data}, topic);
  } catch (const Refusal&) {
    // Refusing is an answer.
  } catch (const Error& error) {
    if (error.fault() != Fault::input) std::abort();
  }
  take_all(maker);
}

std::string known(MessageEncoding encoding) {
  const std::string json = small_ouster_json;
  std::string text = encoding == cdr ? std::string("\0\1\0\0", 4) : std::string();
  for (unsigned i = 0; i < 4; ++i) text += static_cast<char>(json.size() >> (8 * i) & 255U);
  return text + json;
}

}  // namespace
}  // namespace kissmap

KISSMAP_FUZZ_TARGET(packets) {
  if (input.empty()) return;
  const auto first = std::to_integer<unsigned>(input[0]);
  const Topic& topic = topics[first % known_metadata % topics.size()];
  const Topic about{"/ouster/metadata", "std_msgs/String", topic.encoding, std::nullopt};
  const auto maker = make_sweep_maker(topic, {});
  const bool ouster = maker->wants(about);
  if (ouster && first >= known_metadata) {
    const std::string message = known(topic.encoding);
    add(*maker, std::as_bytes(std::span(message)), about);
  }
  try {
    for (ByteCursor cursor(input.subspan(1)); cursor.left() > 0;) {
      const auto length = cursor.value<std::uint16_t>();
      const bool metadata = ouster && length >= is_metadata;
      const auto data = cursor.take(ouster ? length % is_metadata : length);
      add(*maker, data, metadata ? about : topic);
    }
  } catch (const Refusal&) {
    // The last message is cut.
  }
  try {
    maker->finish();
  } catch (const Refusal&) {
    // An Ouster's packets without its metadata.
  }
  take_all(*maker);
}
