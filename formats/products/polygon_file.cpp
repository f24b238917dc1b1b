// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>

#include "formats/files/input_file.hpp"
#include "formats/graphs/line_fields.hpp"
#include "formats/text/lines.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/cloud_export.hpp"

namespace kissmap {

std::vector<Eigen::Vector2d> read_polygon(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = read_side_file(path);
  std::string text(text_of(bytes));
  std::ranges::replace(text, ',', ' ');
  std::vector<Eigen::Vector2d> corners;
  Lines lines(text);
  while (const auto line = lines.next()) {
    const std::string_view content = trimmed(line->substr(0, line->find('#')));
    if (content.empty()) continue;
    LineFields fields(path, lines.number(), content);
    const double x = fields.number("x");
    const double y = fields.number("y");
    fields.end();
    corners.emplace_back(x, y);
  }
  // The first corner given again at the end closes the polygon, which it is anyway.
  if (corners.size() > 3 && corners.front() == corners.back()) corners.pop_back();
  if (corners.size() < 3) {
    throw input_error(path,
                      "holds " + std::to_string(corners.size()) +
                          " corners; a polygon has three or more, one 'x y' a line");
  }
  return corners;
}

}  // namespace kissmap
