// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "kissmap/cloud/map_point.hpp"

namespace kissmap {

/// What a cloud file holds of each point beside x y z.
struct CloudFields {
  bool intensity = false;
  bool time = false;     ///< s since the log's epoch, 64 bits
  bool normals = false;  ///< NaN where there is none
  bool scan = false;     ///< index among the scans of the session
  bool sensor = false;   ///< where the sensor was when it saw the point
  bool rgb = false;
};

struct CloudPoint {
  MapPoint point;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, map axes
  std::array<std::uint8_t, 3> rgb{};
};

struct CloudWriterOptions {
  CloudFields fields;
  /// What coordinates are written relative to [m, map frame]. PCD and PLY, which hold single
  /// precision, name it in a comment; LAS has a place for it.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::string frame = "map";        ///< PCD and PLY name it in a comment
  bool compress = false;            ///< PCD: binary_compressed. Others have no such thing
  std::uint64_t most_points = 0;    ///< no more than these will come; LAS is 1.4 where it has to be
  float most_intensity = 65535.0F;  ///< none is above it; LAS stretches 1 and 255 to 65535
  bool unix_time = true;            ///< LAS: times count from 1970, else from anywhere
};

/// A cloud being written, points as they come: how many is known at the end only. All goes to
/// PATH.partial, which gets its name in finish() and is removed if that is never called. Memory: a
/// buffer; the compressed size of the file for a compressed PCD. Same points, same bytes.
/// Every member throws Error(output) naming the file. Not thread safe.
class CloudWriter {
 public:
  virtual ~CloudWriter() = default;

  /// Throws Error(internal) for coordinates that are not finite.
  virtual void add(const CloudPoint& point) = 0;

  /// Completes the file, flushes it to the disk and gives it its name.
  virtual void finish() = 0;
};

enum class CloudFormat : std::uint8_t { pcd, ply, las };

/// By the ending of a name, in upper or lower case; nothing for other endings.
std::optional<CloudFormat> cloud_format(const std::filesystem::path& path);

/// Replaces whatever file `path` is. PCD v0.7 binary, PLY 1.0 binary little endian, LAS 1.2, by the
/// ending of `path`; Error(usage) for any other. See formats/README.md for the names of fields.
std::unique_ptr<CloudWriter> open_cloud_writer(const std::filesystem::path& path,
                                               const CloudWriterOptions& options);

}  // namespace kissmap
