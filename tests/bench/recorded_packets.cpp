// SPDX-License-Identifier: MIT
#include <cmath>
#include <fstream>
#include <span>

#include "bench/byte_text.hpp"
#include "bench/recorded_logs.hpp"
#include "formats/hesai_packets.hpp"
#include "formats/velodyne_packets.hpp"

namespace kissmap {
namespace {

constexpr std::size_t ouster_beams = 64;
constexpr std::size_t ouster_columns = 1024;
constexpr std::size_t ouster_columns_a_packet = 16;

std::string text_of_bytes(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// 2 mm steps around 10 m, as walls that are not quite round.
unsigned distance_at(std::size_t i) {
  return 5000 + static_cast<unsigned>(400.0 * std::sin(0.01 * static_cast<double>(i)));
}

std::string ouster_packet(std::uint16_t frame, std::size_t first) {
  ByteText packet;
  packet.add<std::uint16_t>(1).add<std::uint16_t>(frame).pad_to(32);
  for (std::size_t column = first; column < first + ouster_columns_a_packet; ++column) {
    const std::uint64_t us = frame * 100'000ULL + column * 97;
    packet.add<std::uint64_t>(1'700'000'000'000'000'000 + us * 1000);
    packet.add<std::uint16_t>(static_cast<std::uint16_t>(column)).add<std::uint16_t>(1);
    for (std::size_t beam = 0; beam < ouster_beams; ++beam) {
      packet.add<std::uint32_t>(2 * distance_at(column + beam)).add<std::uint16_t>(9);
      packet.add<std::uint16_t>(300).add<std::uint32_t>(50);
    }
  }
  return packet.pad_to(packet.size() + 32).text();
}

std::string ouster_metadata() {
  std::string altitudes;
  std::string azimuths;
  for (std::size_t beam = 0; beam < ouster_beams; ++beam) {
    const std::string comma = beam == 0 ? "" : ",";
    altitudes += comma + std::to_string(22.5 - 45.0 * static_cast<double>(beam) / 63.0);
    azimuths += comma + std::to_string(3.0 * static_cast<double>(beam % 4));
  }
  return R"({"prod_line": "OS-1-64", "lidar_mode": "1024x10", "lidar_origin_to_beam_origin_mm": 15.8,
"lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1],
"data_format": {"pixels_per_column": 64, "columns_per_packet": 16, "columns_per_frame": 1024,
"udp_profile_lidar": "RNG19_RFL8_SIG16_NIR16"}, "beam_altitude_angles": [)" +
         altitudes + R"(], "beam_azimuth_angles": [)" + azimuths + "]}";
}

std::string big16(std::size_t value) {
  const auto low = static_cast<char>(value & 255U);
  return {static_cast<char>(value >> 8U), low};
}

/// As Linux captures what a socket gets: an IPv4 packet of any length up to 64 KiB.
std::string datagram(std::string_view payload) {
  return std::string("\x45\0", 2) + big16(payload.size() + 28) + std::string(4, '\0') + "\x40\x11" +
         std::string(10, '\0') + big16(7000) + big16(2368) + big16(payload.size() + 8) + big16(0) +
         std::string(payload);
}

}  // namespace

RecordedPackets record_velodyne(double seconds) {
  constexpr double blocks_a_second = 1e6 / 110.592;  // each of two firings of 55.296 us
  RecordedPackets recorded{blocks_a_second / 12.0, {}, {}};
  const auto count = static_cast<std::size_t>(seconds * recorded.packets_a_second);
  for (std::size_t i = 0; i < count; ++i) {
    const double us = static_cast<double>(i) * 12.0 * 110.592;
    test::VelodynePacket packet(0x22, 0x37, static_cast<std::uint32_t>(us));
    for (std::size_t block = 0; block < 12; ++block) {
      const double turns = (us + 110.592 * static_cast<double>(block)) * 1e-5;  // 10 a second
      packet.azimuth(block, std::lround(36000.0 * turns));
      for (std::size_t shot = 0; shot < 32; ++shot) packet.shot(block, shot, distance_at(i), 60);
    }
    recorded.packets.push_back(text_of_bytes(packet.bytes()));
  }
  return recorded;
}

RecordedPackets record_hesai(double seconds) {
  RecordedPackets recorded{2500.0, {}, {}};
  const auto count = static_cast<std::size_t>(seconds * recorded.packets_a_second);
  for (std::size_t i = 0; i < count; ++i) {
    test::HesaiPacketBytes packet(test::xt_32_kind, 0x37);
    packet.speed(600).microseconds(i * 400 % 1'000'000);
    const std::size_t second = i * 400 / 1'000'000;
    packet.date({123, 11, 14, 22, 13, static_cast<unsigned>(20 + second % 40)});
    for (std::size_t block = 0; block < 8; ++block) {
      packet.azimuth(block, static_cast<long>((i * 8 + block) * 18));
      for (std::size_t laser = 0; laser < 32; ++laser) {
        packet.shot(block, laser, distance_at(i + laser) / 2, 60);
      }
    }
    recorded.packets.push_back(text_of_bytes(packet.bytes()));
  }
  return recorded;
}

RecordedPackets record_ouster(double seconds) {
  RecordedPackets recorded{640.0, {}, ouster_metadata()};
  const auto frames = static_cast<std::uint16_t>(10.0 * seconds);
  for (std::uint16_t frame = 0; frame < frames; ++frame) {
    for (std::size_t first = 0; first < ouster_columns; first += ouster_columns_a_packet) {
      recorded.packets.push_back(ouster_packet(frame, first));
    }
  }
  return recorded;
}

void write_capture(const std::filesystem::path& path, const RecordedPackets& recorded) {
  if (!recorded.metadata.empty()) {
    std::filesystem::path beside = path;
    std::ofstream(beside.replace_extension(".json")) << recorded.metadata;
  }
  constexpr std::uint32_t raw_ip = 101;
  std::ofstream file(path, std::ios::binary);
  file << ByteText()
              .add<std::uint32_t>(0xA1B2C3D4)
              .add<std::uint16_t>(2)
              .add<std::uint16_t>(4)
              .add<std::uint64_t>(0)
              .add<std::uint32_t>(262144)
              .add<std::uint32_t>(raw_ip)
              .text();
  for (std::size_t i = 0; i < recorded.packets.size(); ++i) {
    const std::string frame = datagram(recorded.packets[i]);
    const double seconds = static_cast<double>(i) / recorded.packets_a_second;
    const double whole = std::floor(seconds);
    file << ByteText()
                .add<std::uint32_t>(1'700'000'000 + static_cast<std::uint32_t>(whole))
                .add<std::uint32_t>(static_cast<std::uint32_t>(1e6 * (seconds - whole)))
                .add<std::uint32_t>(static_cast<std::uint32_t>(frame.size()))
                .add<std::uint32_t>(static_cast<std::uint32_t>(frame.size()))
                .add_text(frame)
                .text();
  }
}

}  // namespace kissmap
