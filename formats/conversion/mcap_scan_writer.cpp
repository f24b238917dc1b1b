// SPDX-License-Identifier: MIT
// sensor_msgs/PointCloud2 in plain CDR, little endian (docs.ros.org, common_interfaces).
#include <bit>
#include <cstring>

#include "formats/conversion/mcap_writer.hpp"
#include "formats/conversion/scan_folder.hpp"
#include "formats/conversion/scan_rows.hpp"
#include "formats/conversion/writers.hpp"

namespace kissmap {
namespace {

constexpr std::uint8_t float32 = 7;  // sensor_msgs/PointField

/// The fields and types of the message, which readers of MCAP need to decode it.
std::string point_cloud2_definition() {
  const std::string line(80, '=');
  return "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\n"
         "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n" +
         line +
         "\nMSG: sensor_msgs/PointField\nuint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\n"
         "uint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n"
         "string name\nuint32 offset\nuint8 datatype\nuint32 count\n" +
         line + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
         "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
}

/// Members one after the other, each at a multiple of its size.
class CdrWriter {
 public:
  CdrWriter() : bytes_("\x00\x01\x00\x00", 4) {}

  template <class T>
  void value(T value) {
    bytes_.append((sizeof(T) - (bytes_.size() - 4) % sizeof(T)) % sizeof(T), '\0');
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.append(raw, sizeof(T));
  }
  void text(std::string_view text) {
    value(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text;
    bytes_ += '\0';
  }
  void bytes(std::string_view bytes) {
    value(static_cast<std::uint32_t>(bytes.size()));
    bytes_ += bytes;
  }
  const std::string& message() const { return bytes_; }

 private:
  std::string bytes_;
};

void write_field(CdrWriter& cdr, const char* name, std::uint32_t& offset) {
  cdr.text(name);
  cdr.value(offset);
  cdr.value(float32);
  cdr.value(std::uint32_t{1});
  offset += sizeof(float);
}

std::string point_cloud2(const Scan& scan) {
  constexpr std::int64_t ns_per_s = 1'000'000'000;
  const ScanRows rows{!scan.intensities.empty(), !scan.time_offsets.empty()};
  const auto columns = static_cast<std::uint32_t>(rows.columns());
  const auto count = static_cast<std::uint32_t>(scan.points.size());
  const auto point_step = static_cast<std::uint32_t>(columns * sizeof(float));
  CdrWriter cdr;
  const std::int64_t below_zero = scan.stamp_ns % ns_per_s < 0 ? 1 : 0;
  cdr.value(static_cast<std::int32_t>(scan.stamp_ns / ns_per_s - below_zero));
  cdr.value(static_cast<std::uint32_t>(scan.stamp_ns % ns_per_s + below_zero * ns_per_s));
  cdr.text("lidar");
  cdr.value(std::uint32_t{1});
  cdr.value(count);
  cdr.value(columns);
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z"}) write_field(cdr, name, offset);
  if (rows.with_intensity) write_field(cdr, "intensity", offset);
  if (rows.with_time) write_field(cdr, "time", offset);
  cdr.value(std::uint8_t{0});
  cdr.value(point_step);
  cdr.value(point_step * count);
  cdr.bytes(rows.bytes(scan));
  cdr.value(std::uint8_t{1});
  return cdr.message();
}

class McapScanWriter : public ScanWriter {
 public:
  explicit McapScanWriter(const std::filesystem::path& path)
      : file_(path,
              {"/points",
               "sensor_msgs/msg/PointCloud2",
               "ros2msg",
               point_cloud2_definition(),
               "cdr",
               "ros2"}) {}

  void add(const Scan& scan) override { file_.add(scan.stamp_ns, point_cloud2(scan)); }
  void finish() override { file_.finish(); }

 private:
  McapWriter file_;
};

}  // namespace

std::unique_ptr<ScanWriter> open_mcap_scan_writer(const std::filesystem::path& path) {
  require_free(path);
  return std::make_unique<McapScanWriter>(path);
}

}  // namespace kissmap
