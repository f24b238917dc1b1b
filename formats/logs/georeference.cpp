// SPDX-License-Identifier: MIT
// Records of LAS files: ASPRS LAS 1.4 (2.5, 3.2); keys of coordinate systems: GeoTIFF 1.1.
#include "kissmap/formats/georeference.hpp"

#include <algorithm>
#include <string_view>

#include "formats/clouds/refusal.hpp"
#include "formats/containers/byte_cursor.hpp"
#include "formats/files/input_file.hpp"
#include "formats/text/lines.hpp"
#include "formats/text/lower_case.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using Bytes = std::span<const std::byte>;

constexpr std::string_view fix_types[] = {"sensor_msgs/NavSatFix",
                                          "gps_common/GPSFix",
                                          "gps_msgs/GPSFix",
                                          "nmea_msgs/Sentence",
                                          "foxglove.LocationFix",
                                          "NMEA sentences"};

/// Where a data set keeps fixes or poses on earth, seen from the log's folder or the one above.
struct FixFile {
  std::string_view format;
  const char* name;
  const char* holds;
};
constexpr FixFile fix_files[] = {
    {"kitti-raw", "oxts/data", "latitude, longitude, heights of each scan"},
    {"mulran", "gps.csv", "latitude, longitude, height"},
    {"mulran", "global_pose.csv", "poses in UTM"},
    {"helipr", "Inertial_data/inspva.csv", "latitude, longitude, height"},
    {"nclt", "gps.csv", "latitude, longitude, height"},
    {"nclt", "gps_rtk.csv", "latitude, longitude, height"},
    {"nclt-hits", "gps.csv", "latitude, longitude, height"},
    {"nclt-hits", "gps_rtk.csv", "latitude, longitude, height"},
    {"boreas", "applanix/gps_post_process.csv", "latitude, longitude, height"},
};

void add_files(const LogInfo& about, std::vector<std::string>& found) {
  std::error_code error;
  const fs::path here = fs::is_directory(about.path, error) ? about.path : fs::path();
  const fs::path above = fs::absolute(about.path, error).lexically_normal().parent_path();
  for (const FixFile& file : fix_files) {
    if (about.format != file.format) continue;
    const auto is_there = [&](const fs::path& folder) {
      return !folder.empty() && fs::exists(folder / file.name, error);
    };
    if (is_there(here) || is_there(above) || is_there(above.parent_path())) {
      found.push_back(std::string(file.name) + " (" + file.holds + ")");
    }
  }
}

// The number of a projected or geographic system among the keys of four numbers each.
std::string system_of_keys(Bytes directory) {
  constexpr std::uint16_t geographic = 2048;
  constexpr std::uint16_t projected = 3072;
  constexpr std::uint16_t own_definition = 32767;
  std::string system = "keys of its own";
  ByteCursor cursor(directory);
  cursor.take(8);
  while (cursor.left() >= 8) {
    const auto key = cursor.value<std::uint16_t>();
    const auto place = cursor.value<std::uint16_t>();
    cursor.value<std::uint16_t>();
    const auto value = cursor.value<std::uint16_t>();
    if (place != 0 || value == 0 || value == own_definition) continue;
    if (key == geographic || key == projected) system = "EPSG:" + std::to_string(value);
  }
  return system;
}

std::string las_system(Bytes file) {
  constexpr std::uint16_t well_known_text = 2112;
  constexpr std::uint16_t key_directory = 34735;
  ByteCursor header(file);
  header.take(94);
  const std::size_t header_size = header.value<std::uint16_t>();
  header.value<std::uint32_t>();  // where points begin
  const auto count = header.value<std::uint32_t>();
  ByteCursor records(file);
  records.take(header_size);
  for (std::uint32_t i = 0; i < count; ++i) {
    records.take(2);
    const bool projection = text_of(records.take(16)).starts_with("LASF_Projection");
    const auto id = records.value<std::uint16_t>();
    const std::size_t size = records.value<std::uint16_t>();
    records.take(32);
    const Bytes content = records.take(size);
    if (projection && id == well_known_text) return "WKT";
    if (projection && id == key_directory) return system_of_keys(content);
  }
  return "";
}

void add_las(const LogInfo& about, const std::string& scan, std::vector<std::string>& found) {
  constexpr std::size_t most_header_bytes = 1 << 20;
  std::error_code error;
  if (lower_case(fs::path(scan).extension().string()) != ".las") return;
  const fs::path file = fs::is_directory(about.path, error) ? about.path / scan : about.path;
  const std::vector<std::byte> bytes = first_bytes(file, most_header_bytes);
  if (!text_of(bytes).starts_with("LASF")) return;
  try {
    const std::string system = las_system(bytes);
    if (!system.empty()) found.push_back("coordinate system of " + scan + " (" + system + ")");
  } catch (const Refusal&) {
    // It ends within its header, which is refused when it is read.
  }
}

}  // namespace

std::vector<std::string> find_georeference(const LogInfo& about, const std::string& first_scan) {
  std::vector<std::string> found;
  for (const LogTopic& topic : about.topics) {
    const bool fixes = std::ranges::find(fix_types, topic.type) != std::end(fix_types);
    if (fixes && topic.message_count != 0U) found.push_back("topic " + topic.name);
  }
  add_files(about, found);
  add_las(about, first_scan, found);
  return found;
}

}  // namespace kissmap
