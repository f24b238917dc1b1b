// SPDX-License-Identifier: MIT
// Keys: ros-drivers/velodyne, velodyne_pointcloud/src/lib/calibration.cc and params/64e_*.yaml.
#include "formats/sensors/hdl_64e_calibration.hpp"

#include <yaml-cpp/yaml.h>

#include <bitset>
#include <cmath>
#include <string>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

/// One entry of the list of lasers.
class Entry {
 public:
  Entry(const YAML::Node& node, const std::filesystem::path& origin, std::size_t place)
      : node_(node), origin_(origin), place_(place) {}

  double number(const char* key) const {
    const YAML::Node value = node_[key];
    const double number = value ? value.as<double>(NAN) : NAN;
    if (!std::isfinite(number)) fail(std::string("has no number ") + key);
    return number;
  }
  double number(const char* key, double missing) const {
    return node_[key] ? number(key) : missing;
  }
  bool flag(const char* key) const { return node_[key] && node_[key].as<bool>(false); }

  [[noreturn]] void fail(const std::string& what) const {
    throw input_error(origin_, "entry " + std::to_string(place_ + 1) + " of lasers " + what);
  }

 private:
  const YAML::Node& node_;
  const std::filesystem::path& origin_;
  std::size_t place_;
};

Hdl64eLaser read_laser(const Entry& entry) {
  Hdl64eLaser laser;
  laser.rotation = entry.number("rot_correction");
  laser.elevation = entry.number("vert_correction");
  laser.distance = entry.number("dist_correction");
  laser.two_points = entry.flag("two_pt_correction_available");
  laser.distance_at_x = entry.number("dist_correction_x", laser.distance);
  laser.distance_at_y = entry.number("dist_correction_y", laser.distance);
  laser.vertical_offset = entry.number("vert_offset_correction", 0.0);
  laser.horizontal_offset = entry.number("horiz_offset_correction", 0.0);
  laser.focal_distance = entry.number("focal_distance", 0.0);
  laser.focal_slope = entry.number("focal_slope", 0.0);
  laser.least_intensity = entry.number("min_intensity", 0.0);
  laser.most_intensity = entry.number("max_intensity", 255.0);
  if (laser.least_intensity > laser.most_intensity) {
    entry.fail("has a min_intensity above its max_intensity");
  }
  return laser;
}

}  // namespace

Hdl64eCalibration read_hdl_64e_calibration(std::string_view yaml,
                                           const std::filesystem::path& origin) {
  YAML::Node root;
  try {
    root = YAML::Load(std::string(yaml));
  } catch (const YAML::Exception& error) {
    throw input_error(origin, std::string("is no YAML: ") + error.what());
  }
  const YAML::Node lasers = root.IsMap() ? root["lasers"] : YAML::Node();
  if (!lasers || !lasers.IsSequence() || lasers.size() != hdl_64e_lasers) {
    throw input_error(origin,
                      "is no calibration of an HDL-64E: it wants a list of 64 lasers, as the ROS "
                      "driver's gen_calibration.py makes it from db.xml");
  }
  Hdl64eCalibration calibration;
  std::bitset<hdl_64e_lasers> known;
  for (std::size_t i = 0; i < lasers.size(); ++i) {
    const YAML::Node node = lasers[i];
    const Entry entry(node, origin, i);
    if (!node.IsMap()) entry.fail("holds no keys");
    const double id = entry.number("laser_id");
    if (id < 0.0 || id >= static_cast<double>(hdl_64e_lasers) || id != std::floor(id)) {
      entry.fail("has a laser_id that is not 0 to 63");
    }
    const auto laser = static_cast<std::size_t>(id);
    if (known.test(laser)) entry.fail("repeats laser_id " + std::to_string(laser));
    known.set(laser);
    calibration[laser] = read_laser(entry);
  }
  return calibration;
}

}  // namespace kissmap
