// SPDX-License-Identifier: MIT
// Logs as recorders write them, of one cloud or one turn of packets over and over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kissmap {

/// How a driver lays out the points of a cloud.
enum class PointLayout { ouster_48, velodyne_22 };  // bytes a point

/// Clouds of 64 x 1024 points in a hall: the data of a PointCloud2, `point_step` bytes a point.
struct RecordedClouds {
  PointLayout layout = PointLayout::ouster_48;
  std::vector<std::string> different;
  std::size_t count = 0;  ///< of messages to write; they come around
  std::size_t point_step() const { return layout == PointLayout::ouster_48 ? 48 : 22; }
  const std::string& data(std::size_t i) const { return different[i % different.size()]; }
};
RecordedClouds record_clouds(PointLayout layout, std::size_t count);

/// The time at which cloud `i` was recorded [ns since 1970], and its sensor_msgs/PointCloud2 as
/// ROS 2 (`cdr`) or ROS 1 serialises it.
std::uint64_t recorded_ns(std::size_t i);
std::string cloud_message(const RecordedClouds& clouds, std::size_t i, bool cdr);

inline constexpr std::size_t cloud_rows = 64;
inline constexpr std::size_t cloud_columns = 1024;

struct McapOptions {
  std::string_view compression;  ///< "", "lz4" or "zstd"
  bool checksums = true;
};
void write_ros1_bag(const std::filesystem::path& file, const RecordedClouds& clouds);
void write_ros2_bag(const std::filesystem::path& file, const RecordedClouds& clouds);
void write_mcap(const std::filesystem::path& file,
                const RecordedClouds& clouds,
                const McapOptions& options);
void write_pcd_folder(const std::filesystem::path& folder, const RecordedClouds& clouds);

/// A sensor's packets, in the order they are sent in.
struct RecordedPackets {
  double packets_a_second = 0.0;  ///< as the sensor sends them
  std::vector<std::string> packets;
  std::string metadata;  ///< JSON that has to lie beside the capture, or empty
};
RecordedPackets record_velodyne(double seconds);  ///< VLP-16
RecordedPackets record_hesai(double seconds);     ///< PandarXT-32
RecordedPackets record_ouster(double seconds);    ///< 64 x 1024, 10 Hz, RNG19_RFL8_SIG16_NIR16
void write_capture(const std::filesystem::path& file, const RecordedPackets& recorded);

}  // namespace kissmap
