// SPDX-License-Identifier: MIT
#pragma once

namespace kissmap {

/// Metadata of an Ouster of two beams, whose packets are 640 bytes long.
inline constexpr const char* small_ouster_json = R"({"prod_line": "OS-1-2",
"lidar_mode": "1024x10", "beam_altitude_angles": [0.0, 30.0], "beam_azimuth_angles": [0.0, 90.0],
"lidar_origin_to_beam_origin_mm": 10.0,
"lidar_to_sensor_transform": [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 36.18, 0, 0, 0, 1],
"data_format": {"pixels_per_column": 2, "columns_per_packet": 16, "columns_per_frame": 1024,
"udp_profile_lidar": "RNG19_RFL8_SIG16_NIR16"}})";

}  // namespace kissmap
