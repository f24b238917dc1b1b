// SPDX-License-Identifier: MIT
#include "formats/sensors/hesai_angle_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "formats/text/lines.hpp"
#include "formats/text/lower_case.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr std::size_t most_channels = 256;
constexpr double steepest_deg = 90.0;
constexpr double most_turned_deg = 360.0;

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = std::min(line.find(','), line.size());
    cells.push_back(trimmed(line.substr(0, end)));
    if (end == line.size()) return cells;
    line.remove_prefix(end + 1);
  }
}

std::optional<double> number_in(std::string_view cell) {
  double value = 0.0;
  if (cell.starts_with('+')) cell.remove_prefix(1);
  const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  const bool whole = result.ec == std::errc{} && result.ptr == cell.data() + cell.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Where the columns stand.
struct Columns {
  std::size_t channel = 0;
  std::size_t elevation = 0;
  std::size_t azimuth = 0;
};

std::optional<std::size_t> column_beginning(const std::vector<std::string_view>& cells,
                                            std::string_view name) {
  const auto found = std::ranges::find_if(cells, [&](std::string_view cell) {
    return lower_case(std::string(cell)).starts_with(name);
  });
  if (found == cells.end()) return std::nullopt;
  return static_cast<std::size_t>(found - cells.begin());
}

std::optional<Columns> header_in(const std::vector<std::string_view>& cells) {
  auto channel = column_beginning(cells, "channel");
  if (!channel) channel = column_beginning(cells, "laser");
  const auto elevation = column_beginning(cells, "elev");
  const auto azimuth = column_beginning(cells, "azi");
  if (!channel || !elevation || !azimuth) return std::nullopt;
  return Columns{*channel, *elevation, *azimuth};
}

}  // namespace

HesaiAngles read_hesai_angles(std::string_view csv, const std::filesystem::path& origin) {
  if (csv.starts_with("\xEF\xBB\xBF")) csv.remove_prefix(3);
  Lines lines(csv);
  const auto fail = [&](const std::string& what) {
    throw input_error(origin, "line " + std::to_string(lines.number()) + ": " + what);
  };
  std::optional<Columns> columns;
  while (!columns) {
    const auto line = lines.next_not_blank();
    if (!line) {
      throw input_error(origin,
                        "is no file of Hesai's angles: it wants the columns Channel, Elevation "
                        "and Azimuth");
    }
    columns = header_in(cells_of(*line));
  }
  HesaiAngles angles;
  while (const auto line = lines.next_not_blank()) {
    const std::vector<std::string_view> cells = cells_of(*line);
    if (cells.size() <= std::max({columns->channel, columns->elevation, columns->azimuth})) {
      fail("has " + std::to_string(cells.size()) + " columns, fewer than the header");
    }
    const auto channel = number_in(cells[columns->channel]);
    const auto elevation = number_in(cells[columns->elevation]);
    const auto azimuth = number_in(cells[columns->azimuth]);
    if (channel != static_cast<double>(angles.size() + 1) || angles.size() >= most_channels) {
      fail("channel " + in_quotes(cells[columns->channel]) + " instead of " +
           std::to_string(angles.size() + 1));
    }
    if (!elevation || std::abs(*elevation) > steepest_deg) {
      fail(in_quotes(cells[columns->elevation]) + " is no elevation in degrees");
    }
    if (!azimuth || std::abs(*azimuth) > most_turned_deg) {
      fail(in_quotes(cells[columns->azimuth]) + " is no azimuth in degrees");
    }
    angles.push_back({*elevation, *azimuth});
  }
  if (angles.empty()) throw input_error(origin, "names no channel");
  return angles;
}

}  // namespace kissmap
