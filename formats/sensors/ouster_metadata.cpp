// SPDX-License-Identifier: MIT
#include "formats/sensors/ouster_metadata.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/text/lower_case.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t most_beams = 512;
constexpr std::size_t most_columns = 8192;

/// Where values stand in the nested layout; in the flat one they are at the top.
constexpr const char* sections[] = {"sensor_info",
                                    "config_params",
                                    "lidar_data_format",
                                    "data_format",
                                    "beam_intrinsics",
                                    "lidar_intrinsics"};

const json* find(const json& root, const char* key) {
  if (root.contains(key)) return &root[key];
  for (const char* section : sections) {
    if (root.contains(section) && root[section].is_object() && root[section].contains(key)) {
      return &root[section][key];
    }
  }
  return nullptr;
}

class Reader {
 public:
  Reader(const json& root, const fs::path& origin) : root_(root), origin_(origin) {}

  [[noreturn]] void refuse(const char* key, const std::string& what) const {
    throw input_error(origin_, std::string("Ouster metadata: '") + key + "' " + what);
  }

  template <class T>
  std::optional<T> value(const char* key) const {
    const json* found = find(root_, key);
    if (found == nullptr || found->is_null()) return std::nullopt;
    // The library converts any number to any other.
    if constexpr (std::is_integral_v<T>) {
      if (!found->is_number_integer()) refuse(key, "is not a whole number");
    }
    try {
      return found->get<T>();
    } catch (const json::exception&) {
      refuse(key, "is not of the right kind");
    }
  }

  std::size_t size(const char* key, std::size_t otherwise, std::size_t most) const {
    const auto number = value<std::int64_t>(key);
    if (!number) return otherwise;
    if (*number < 1 || *number > static_cast<std::int64_t>(most)) {
      refuse(key, "is " + std::to_string(*number) + ", not within 1.." + std::to_string(most));
    }
    return static_cast<std::size_t>(*number);
  }

  std::vector<double> numbers(const char* key, std::size_t count) const {
    const auto list = value<std::vector<double>>(key);
    if (!list) refuse(key, "is missing");
    if (list->size() != count ||
        !std::ranges::all_of(*list, [](double v) { return std::isfinite(v); })) {
      refuse(key, "has to be " + std::to_string(count) + " numbers");
    }
    return *list;
  }

  std::optional<Eigen::Matrix4d> matrix(const char* key) const {
    if (find(root_, key) == nullptr) return std::nullopt;
    const std::vector<double> m = numbers(key, 16);
    return Eigen::Matrix<double, 4, 4, Eigen::RowMajor>(m.data());
  }

 private:
  const json& root_;
  const fs::path& origin_;
};

/// "1024x10": columns a turn.
std::size_t columns_of_mode(const std::string& mode) {
  std::size_t columns = 0;
  std::from_chars(mode.data(), mode.data() + mode.size(), columns);
  return columns;
}

double default_origin_mm(const std::string& product) {
  if (product.starts_with("OS-0")) return 27.67;
  if (product.starts_with("OS-2")) return 13.762;
  return product.starts_with("OS-1") ? 15.806 : 12.163;
}

Eigen::Isometry3d default_sensor_from_lidar() {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  transform.translation().z() = 36.18;
  return transform;
}

void read_optics(const Reader& reader, OusterMetadata& about) {
  about.altitudes_deg = reader.numbers("beam_altitude_angles", about.beams);
  about.azimuths_deg = reader.numbers("beam_azimuth_angles", about.beams);
  const auto beam = reader.matrix("beam_to_lidar_transform");
  if (beam) {
    about.lidar_from_beam_origin_mm = beam->block<3, 1>(0, 3);
  } else {
    about.lidar_from_beam_origin_mm.x() = reader.value<double>("lidar_origin_to_beam_origin_mm")
                                              .value_or(default_origin_mm(about.product));
  }
  const auto transform = reader.matrix("lidar_to_sensor_transform");
  about.sensor_from_lidar_mm =
      transform ? Eigen::Isometry3d(*transform) : default_sensor_from_lidar();
}

std::size_t common_beginning(const std::string& a, const std::string& b) {
  return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

}  // namespace

OusterMetadata read_ouster_metadata(std::string_view text, const fs::path& origin) {
  const json root = json::parse(text, nullptr, false);
  if (!root.is_object())
    throw input_error(origin, "is no JSON with the metadata of an Ouster sensor");
  const Reader reader(root, origin);
  OusterMetadata about;
  about.product = reader.value<std::string>("prod_line").value_or("");
  about.profile = reader.value<std::string>("udp_profile_lidar").value_or("LEGACY");
  about.beams = reader.size("pixels_per_column", 64, most_beams);
  about.columns_per_packet = reader.size("columns_per_packet", 16, most_columns);
  const std::size_t by_mode = columns_of_mode(reader.value<std::string>("lidar_mode").value_or(""));
  about.columns_per_frame = reader.size("columns_per_frame", by_mode, most_columns);
  if (about.columns_per_frame < 1 || about.columns_per_frame > most_columns) {
    reader.refuse("columns_per_frame", "is missing, and lidar_mode tells nothing");
  }
  about.initialization_id = reader.value<std::uint32_t>("initialization_id");
  about.lidar_port = reader.value<std::uint16_t>("udp_port_lidar");
  read_optics(reader, about);
  return about;
}

fs::path find_ouster_metadata(const fs::path& capture) {
  fs::path same = capture;
  same.replace_extension(".json");
  std::error_code error;
  if (fs::is_regular_file(same, error)) return same;
  const std::string name = capture.stem().string();
  fs::path best;
  std::size_t longest = 0;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::absolute(capture).parent_path(), error)) {
    if (lower_case(entry.path().extension().string()) == ".json") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    const std::size_t common = common_beginning(file.stem().string(), name);
    if (common <= longest) continue;
    longest = common;
    best = file;
  }
  if (!best.empty()) return best;
  throw input_error(
      capture,
      "holds no packets that tell their sensor. Those of an Ouster do not, and want its metadata: "
      "put the JSON file beside the capture, as " +
          same.filename().string());
}

}  // namespace kissmap
