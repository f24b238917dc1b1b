// SPDX-License-Identifier: MIT
// PCD v0.7, https://pointclouds.org/documentation/tutorials/pcd_file_format.html
#include <limits>

#include "formats/clouds/lzf_pack.hpp"
#include "formats/clouds/point_columns.hpp"
#include "formats/files/aside_file.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr std::size_t longest_number = 20;
constexpr std::size_t plane_piece = std::size_t{1} << 18U;  // bytes packed at once

// PCL wants the bits 0x00RRGGBB in a float called rgb.
const std::vector<PointColumn> pcd_colour = {{"rgb", "", ScalarType::f32}};

char type_letter(ScalarType type) {
  return type == ScalarType::u32 ? 'U' : 'F';
}

class PcdWriter : public CloudWriter {
 public:
  PcdWriter(const std::filesystem::path& path, const CloudWriterOptions& options)
      : options_(options), columns_(point_columns(options.fields, pcd_colour)), file_(path) {
    file_.write(header());
  }

 protected:
  /// The values of a point, in the order of the columns.
  const std::string& record_of(const CloudPoint& point) {
    record_.clear();
    append_columns(point, options_, record_);
    if (options_.fields.rgb) {
      append_value(
          static_cast<std::uint32_t>(point.rgb[0] << 16 | point.rgb[1] << 8 | point.rgb[2]),
          record_);
    }
    ++points_;
    return record_;
  }

  /// As long for any number of points, so that the final one fits over the first.
  std::string header() const {
    std::string fields;
    std::string sizes;
    std::string types;
    std::string counts;
    for (const PointColumn& column : columns_) {
      fields += std::string(" ") + column.pcd_name;
      sizes += " " + std::to_string(size_of(column.type));
      types += std::string(" ") + type_letter(column.type);
      counts += " 1";
    }
    const std::string number = std::to_string(points_);
    const std::string filling(2 * (longest_number - number.size()), ' ');
    return "# .PCD v0.7 - Point Cloud Data file format\n# " + frame_comment(options_) + filling +
           "\nVERSION 0.7\nFIELDS" + fields + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" +
           counts + "\nWIDTH " + number + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number +
           "\nDATA " + (options_.compress ? "binary_compressed" : "binary") + "\n";
  }

  const std::vector<PointColumn>& columns() const { return columns_; }
  AsideFile& file() { return file_; }
  std::uint64_t points() const { return points_; }

 private:
  CloudWriterOptions options_;
  std::vector<PointColumn> columns_;
  AsideFile file_;
  std::uint64_t points_ = 0;
  std::string record_;
};

class BinaryPcdWriter : public PcdWriter {
 public:
  using PcdWriter::PcdWriter;
  void add(const CloudPoint& point) override { file().write(record_of(point)); }
  void finish() override { file().publish(header()); }
};

/// All x, then all y, ...: each plane is packed as it grows, and waits in memory for those before.
class CompressedPcdWriter : public PcdWriter {
 public:
  CompressedPcdWriter(const std::filesystem::path& path, const CloudWriterOptions& options)
      : PcdWriter(path, options), planes_(columns().size()) {}

  void add(const CloudPoint& point) override {
    const std::string& record = record_of(point);
    std::size_t begin = 0;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const std::size_t size = size_of(columns()[i].type);
      planes_[i].raw.append(record, begin, size);
      begin += size;
      if (planes_[i].raw.size() >= plane_piece) pack(planes_[i]);
    }
    require_room(points() * record.size());
  }

  void finish() override {
    std::uint64_t raw_size = 0;
    for (const PointColumn& column : columns()) raw_size += points() * size_of(column.type);
    std::uint64_t packed_size = 0;
    for (Plane& plane : planes_) {
      pack(plane);
      packed_size += plane.packed.size();
    }
    require_room(packed_size);
    std::string sizes;
    append_value(static_cast<std::uint32_t>(packed_size), sizes);
    append_value(static_cast<std::uint32_t>(raw_size), sizes);
    file().write(sizes);
    for (const Plane& plane : planes_) file().write(plane.packed);
    file().publish(header());
  }

 private:
  struct Plane {
    std::string raw;  ///< not packed yet
    std::string packed;
  };

  static void pack(Plane& plane) {
    append_lzf(plane.raw, plane.packed);
    plane.raw.clear();
  }

  void require_room(std::uint64_t size) {
    if (size <= std::numeric_limits<std::uint32_t>::max()) return;
    throw output_error(file().path(),
                       "a compressed PCD holds 4 GiB of points at most; write it without "
                       "compression, as .las, or in tiles");
  }

  std::vector<Plane> planes_;
};

}  // namespace

std::unique_ptr<CloudWriter> open_pcd_writer(const std::filesystem::path& path,
                                             const CloudWriterOptions& options) {
  if (options.compress) return std::make_unique<CompressedPcdWriter>(path, options);
  return std::make_unique<BinaryPcdWriter>(path, options);
}

}  // namespace kissmap
