// SPDX-License-Identifier: MIT
#include "formats/products/offset_file.hpp"

#include <fstream>
#include <system_error>

#include "formats/clouds/point_columns.hpp"
#include "formats/files/output_file.hpp"

namespace kissmap {
namespace {

constexpr std::string_view first_line = "# add to x y z of the points [m]\n";

bool is_offset_file(const std::filesystem::path& path) {
  std::string begin(first_line.size(), '\0');
  std::ifstream(path).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == first_line;
}

}  // namespace

std::string offset_text(const Eigen::Vector3d& offset) {
  return std::string(first_line) + shortest_decimal(offset.x()) + " " +
         shortest_decimal(offset.y()) + " " + shortest_decimal(offset.z()) + "\n";
}

std::filesystem::path write_offset_file(const std::filesystem::path& output,
                                        const Eigen::Vector3d& offset) {
  std::filesystem::path file = output.string() + ".offset.txt";
  std::error_code ignored;
  if (is_offset_file(file)) std::filesystem::remove(file, ignored);
  if (offset.isZero(0.0)) return {};
  write_whole_file(file, offset_text(offset));
  return file;
}

}  // namespace kissmap
