// SPDX-License-Identifier: MIT
#include "formats/logs/kitti_calibration.hpp"

#include <charconv>
#include <cmath>

#include "formats/files/input_file.hpp"
#include "formats/text/lines.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

double number(std::string_view word, const std::filesystem::path& path, std::size_t line) {
  double value = 0.0;
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || stop != end || !std::isfinite(value)) {
    throw input_error(path,
                      "line " + std::to_string(line) + ": " + in_quotes(word) +
                          " where one of 12 numbers is due");
  }
  return value;
}

}  // namespace

Rigid3 read_kitti_cam0_from_lidar(const std::filesystem::path& calib_txt) {
  const std::vector<std::byte> bytes = read_side_file(calib_txt);
  Lines lines(text_of(bytes));
  while (auto line = lines.next()) {
    const std::string_view key = next_word(*line);
    if (key != "Tr:" && key != "Tr_velo_to_cam:") continue;
    Eigen::Matrix<double, 3, 4> matrix;
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) {
        matrix(row, column) = number(next_word(*line), calib_txt, lines.number());
      }
    }
    return Rigid3::from_matrix(matrix);
  }
  throw input_error(calib_txt, "no line 'Tr:' with the pose of the LiDAR in camera 0");
}

}  // namespace kissmap
