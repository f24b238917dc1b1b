// SPDX-License-Identifier: MIT
#include "kissmap/formats/cloud_writer.hpp"

#include <array>
#include <charconv>

#include "formats/clouds/point_columns.hpp"
#include "formats/text/lower_case.hpp"
#include "kissmap/error.hpp"

namespace kissmap {

std::string shortest_decimal(double value) {
  std::array<char, 32> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

void append_vector(const Eigen::Vector3f& vector, std::string& bytes) {
  for (const float value : vector) append_value(value, bytes);
}

std::vector<PointColumn> point_columns(const CloudFields& fields,
                                       const std::vector<PointColumn>& colour) {
  using enum ScalarType;
  std::vector<PointColumn> columns = {{"x", "x", f32}, {"y", "y", f32}, {"z", "z", f32}};
  const auto add = [&columns](std::initializer_list<PointColumn> more) {
    columns.insert(columns.end(), more);
  };
  if (fields.intensity) add({{"intensity", "intensity", f32}});
  if (fields.normals) {
    add({{"normal_x", "nx", f32}, {"normal_y", "ny", f32}, {"normal_z", "nz", f32}});
  }
  if (fields.time) add({{"timestamp", "timestamp", f64}});
  if (fields.scan) add({{"scan", "scan", u32}});
  if (fields.sensor) {
    add({{"vp_x", "sensor_x", f32}, {"vp_y", "sensor_y", f32}, {"vp_z", "sensor_z", f32}});
  }
  if (fields.rgb) columns.insert(columns.end(), colour.begin(), colour.end());
  return columns;
}

void append_columns(const CloudPoint& point,
                    const CloudWriterOptions& options,
                    std::string& bytes) {
  const MapPoint& p = point.point;
  if (!p.position.allFinite()) {
    throw Error(Fault::internal, "a point to be written is not finite");
  }
  const Eigen::Vector3d local = p.position - options.offset;
  append_vector(local.cast<float>(), bytes);
  if (options.fields.intensity) append_value(p.intensity, bytes);
  if (options.fields.normals) append_vector(point.normal, bytes);
  if (options.fields.time) append_value(p.time, bytes);
  if (options.fields.scan) append_value(p.scan_idx, bytes);
  if (options.fields.sensor) {
    append_vector((local + p.to_sensor.cast<double>()).cast<float>(), bytes);
  }
}

std::string frame_comment(const CloudWriterOptions& options) {
  std::string comment = "made by kissmap; frame " + options.frame + ", metres";
  if (!options.offset.isZero(0.0)) {
    comment += "; add to x y z:";
    for (const double value : options.offset) comment += " " + shortest_decimal(value);
  }
  return comment;
}

std::optional<CloudFormat> cloud_format(const std::filesystem::path& path) {
  const std::string ending = lower_case(path.extension().string());
  if (ending == ".pcd") return CloudFormat::pcd;
  if (ending == ".ply") return CloudFormat::ply;
  if (ending == ".las") return CloudFormat::las;
  return std::nullopt;
}

std::unique_ptr<CloudWriter> open_cloud_writer(const std::filesystem::path& path,
                                               const CloudWriterOptions& options) {
  const std::optional<CloudFormat> format = cloud_format(path);
  if (format == CloudFormat::pcd) return open_pcd_writer(path, options);
  if (format == CloudFormat::ply) return open_ply_writer(path, options);
  if (format == CloudFormat::las) return open_las_writer(path, options);
  throw usage_error(path.string() + ": a cloud is written to .pcd, .ply or .las");
}

}  // namespace kissmap
