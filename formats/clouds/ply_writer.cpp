// SPDX-License-Identifier: MIT
// PLY 1.0 (Greg Turk, "The PLY Polygon File Format", 1994), binary little endian.
#include "formats/clouds/point_columns.hpp"
#include "formats/files/aside_file.hpp"

namespace kissmap {
namespace {

constexpr std::size_t longest_number = 20;

const std::vector<PointColumn> ply_colour = {
    {"", "red", ScalarType::u8}, {"", "green", ScalarType::u8}, {"", "blue", ScalarType::u8}};

const char* type_name(ScalarType type) {
  switch (type) {
    case ScalarType::u8:
      return "uchar";
    case ScalarType::u32:
      return "uint";
    case ScalarType::f64:
      return "double";
    default:
      return "float";
  }
}

class PlyWriter : public CloudWriter {
 public:
  PlyWriter(const std::filesystem::path& path, const CloudWriterOptions& options)
      : options_(options), file_(path) {
    file_.write(header());
  }

  void add(const CloudPoint& point) override {
    record_.clear();
    append_columns(point, options_, record_);
    if (options_.fields.rgb) {
      for (const std::uint8_t channel : point.rgb) append_value(channel, record_);
    }
    file_.write(record_);
    ++points_;
  }

  void finish() override { file_.publish(header()); }

 private:
  /// As long for any number of points, so that the final one fits over the first.
  std::string header() const {
    const std::string number = std::to_string(points_);
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment " + frame_comment(options_) +
                       std::string(longest_number - number.size(), ' ') + "\nelement vertex " +
                       number + "\n";
    for (const PointColumn& column : point_columns(options_.fields, ply_colour)) {
      text += std::string("property ") + type_name(column.type) + " " + column.ply_name + "\n";
    }
    return text + "end_header\n";
  }

  CloudWriterOptions options_;
  AsideFile file_;
  std::uint64_t points_ = 0;
  std::string record_;
};

}  // namespace

std::unique_ptr<CloudWriter> open_ply_writer(const std::filesystem::path& path,
                                             const CloudWriterOptions& options) {
  return std::make_unique<PlyWriter>(path, options);
}

}  // namespace kissmap
