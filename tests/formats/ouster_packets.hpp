// SPDX-License-Identifier: MIT
// Metadata and data packets of a small Ouster sensor of two beams, as its manual lays them out.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/sensors/ouster_metadata.hpp"
#include "formats/support.hpp"

namespace kissmap::test {

/// One beam is level and looks along the encoder, the other 30 degrees up and 90 aside of it.
inline nlohmann::json small_ouster(const std::string& profile) {
  std::vector<double> transform{-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1};
  return {{"prod_line", "OS-1-2"},
          {"lidar_mode", "1024x10"},
          {"beam_altitude_angles", {0.0, 30.0}},
          {"beam_azimuth_angles", {0.0, 90.0}},
          {"lidar_origin_to_beam_origin_mm", 10.0},
          {"lidar_to_sensor_transform", transform},
          {"initialization_id", 77},
          {"data_format",
           {{"pixels_per_column", 2},
            {"columns_per_packet", 16},
            {"columns_per_frame", 1024},
            {"udp_profile_lidar", profile}}}};
}

inline OusterMetadata ouster_metadata_of(const nlohmann::json& values) {
  return read_ouster_metadata(values.dump(), "m.json");
}

/// A packet of 16 columns. `words` are those of both pixels of a column, 32 bits each.
class OusterPacketBytes {
 public:
  OusterPacketBytes(bool legacy, std::uint16_t frame) : legacy_(legacy), frame_(frame) {
    if (legacy) return;
    bytes_.add<std::uint16_t>(1).add<std::uint16_t>(frame).add<std::uint32_t>(77).pad(24);
  }

  OusterPacketBytes& column(std::int64_t time_ns,
                            std::size_t number,
                            const std::vector<std::uint32_t>& words,
                            bool valid = true) {
    bytes_.add<std::uint64_t>(static_cast<std::uint64_t>(time_ns));
    bytes_.add<std::uint16_t>(static_cast<std::uint16_t>(number));
    if (legacy_) {
      bytes_.add<std::uint16_t>(frame_).add<std::uint32_t>(0x5A5A5A5A);  // encoder
    } else {
      // Bits but the lowest tell other things.
      bytes_.add<std::uint16_t>(valid ? 0xFFFF : 0xFFFE);
    }
    for (const std::uint32_t word : words) bytes_.add<std::uint32_t>(word);
    if (legacy_) bytes_.add<std::uint32_t>(valid ? 0xFFFFFFFF : 0);
    return *this;
  }

  std::string text() const {
    Bytes whole = bytes_;
    if (!legacy_) whole.pad(32);
    return whole.text();
  }

 private:
  bool legacy_;
  std::uint16_t frame_;
  Bytes bytes_;
};

}  // namespace kissmap::test
