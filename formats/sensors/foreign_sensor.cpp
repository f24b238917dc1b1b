// SPDX-License-Identifier: MIT
// Marks and layouts of packets: RoboSense, rs_driver (decoder_*.hpp); Livox, Livox-SDK2
// (livox_lidar_def.h) and the communication protocol of Livox-SDK; Hesai, HesaiLidar_SDK_2.0
// (udp_parser.cc) and HesaiLidar_General_SDK.
#include "formats/sensors/foreign_sensor.hpp"

#include <algorithm>
#include <string_view>

#include "formats/sensors/packet_bytes.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

using namespace std::string_view_literals;

constexpr const char* robosense_tools = "RoboSense's rslidar_sdk or RSView";
constexpr const char* livox_tools = "livox_ros_driver2 or Livox Viewer 2";
constexpr const char* early_livox_tools = "livox_ros_driver or Livox Viewer";
constexpr const char* hesai_tools = "Hesai's HesaiLidar_ROS_2.0 or PandarView";
constexpr const char* velodyne_tools = "the ROS driver velodyne_pointcloud or VeloView";

struct Mark {
  std::string_view first_bytes;
  const char* sensors;
  const char* tools;
};
constexpr Mark marks[] = {
    {"\x55\xAA\x05\x0A\x5A\xA5\x50\xA0"sv,
     "RoboSense RS-LiDAR-16, RS-LiDAR-32 or Bpearl",
     robosense_tools},
    {"\x55\xAA\x05\x5A"sv, "RoboSense of the Ruby, Helios, RS-128 or Airy kind", robosense_tools},
    {"\x55\xAA\x5A\xA5"sv, "RoboSense of the M or E series", robosense_tools},
};

struct Protocol {
  unsigned major;
  unsigned minor;
  const char* sensors;
};
constexpr Protocol hesai_protocols[] = {
    {1, 3, "Pandar128"},
    {1, 4, "Pandar128, OT128 or JT128"},
    {1, 8, "JT16"},
    {3, 1, "PandarQT (QT64)"},
    {4, 1, "AT128"},
    {4, 3, "AT128"},
    {4, 7, "ATX"},
    {7, 2, "FT120"},
    {20, 20, "Pandar20"},  // its numbers of lasers and blocks, where others have a version
};

/// Livox packets have no mark, but a size that follows from their head.
struct Shots {
  unsigned data_type;
  std::size_t count;  ///< 0: told by the packet
  std::size_t bytes;  ///< of one
};
constexpr Shots livox_shots[] = {{1, 0, 14}, {2, 0, 8}, {3, 0, 10}, {0x11, 0, 28}};
constexpr Shots early_livox_shots[] = {
    {0, 100, 13}, {1, 100, 9}, {2, 96, 14}, {3, 96, 10}, {4, 48, 28}, {5, 48, 16}, {7, 30, 42}};

std::string cure(const std::string& tools) {
  return "make a bag or MCAP file of PointCloud2, or PCD files, of it with " + tools;
}

std::string refusal(const std::string& sensors, const std::string& tools) {
  return "packets of a " + sensors + ", which are not read; " + cure(tools);
}

// Version 0, then its own length.
bool is_livox(const PacketBytes& bytes) {
  constexpr std::size_t head = 36;
  if (bytes.size() <= head || bytes.u8(0) != 0 || bytes.u16(1) != bytes.size()) return false;
  return std::ranges::any_of(livox_shots, [&](const Shots& shots) {
    return bytes.u8(10) == shots.data_type && head + bytes.u16(5) * shots.bytes == bytes.size();
  });
}

bool is_early_livox(const PacketBytes& bytes) {
  constexpr std::size_t head = 18;
  constexpr unsigned version = 5;
  if (bytes.size() <= head || bytes.u8(0) != version) return false;
  return std::ranges::any_of(early_livox_shots, [&](const Shots& shots) {
    return bytes.u8(9) == shots.data_type && head + shots.count * shots.bytes == bytes.size();
  });
}

}  // namespace

std::optional<std::string> describe_foreign_sensor(std::span<const std::byte> payload) {
  for (const Mark& mark : marks) {
    if (text_of(payload).starts_with(mark.first_bytes)) return refusal(mark.sensors, mark.tools);
  }
  const PacketBytes bytes(payload);
  if (is_livox(bytes)) {
    return refusal("Livox of the second generation (Mid-360, HAP)", livox_tools);
  }
  if (is_early_livox(bytes)) {
    return refusal("Livox of the first generation (Mid, Horizon, Tele, Avia)", early_livox_tools);
  }
  return std::nullopt;
}

std::string describe_unread_hesai(const HesaiMark& mark) {
  const auto* known = std::ranges::find_if(hesai_protocols, [&](const Protocol& protocol) {
    return protocol.major == mark.major && protocol.minor == mark.minor;
  });
  const bool qt_64 = mark.lasers == 64 && mark.blocks == 4;  // whatever its protocol
  const std::string model = known != std::end(hesai_protocols) ? known->sensors
                            : qt_64                            ? "PandarQT (QT64)"
                                                               : "of an unknown model";
  return refusal("Hesai " + model + " (protocol " + std::to_string(mark.major) + "." +
                     std::to_string(mark.minor) + ", " + std::to_string(mark.lasers) +
                     " lasers in " + std::to_string(mark.blocks) + " blocks)",
                 hesai_tools);
}

std::string unread_velodyne_cure() {
  return cure(velodyne_tools);
}

}  // namespace kissmap
