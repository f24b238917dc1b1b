// SPDX-License-Identifier: MIT
#include "formats/clouds/bin.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "formats/clouds/gather.hpp"
#include "formats/clouds/refusal.hpp"

namespace kissmap {
namespace {

constexpr int common_columns[] = {4, 5, 6};

constexpr std::size_t row_bytes(int columns) {
  return static_cast<std::size_t>(columns) * sizeof(float);
}

const char* column_name(std::size_t column, int columns) {
  constexpr const char* names[] = {"x", "y", "z", "intensity"};
  if (column < std::size(names)) return names[column];
  return column == 5 && columns == 6 ? "time" : "_";
}

bool divides_all(int columns, const std::vector<std::uint64_t>& sizes) {
  return std::ranges::all_of(sizes, [&](auto size) { return size % row_bytes(columns) == 0; });
}

bool coordinates_are_plausible(std::span<const std::byte> sample, int columns) {
  const PointRecords records = read_bin(sample, columns);
  for (std::size_t i = 0; i < records.count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::byte* at = records.bytes.data() + i * row_bytes(columns) + axis * sizeof(float);
      const auto value = gather_detail::load<float>(at, std::endian::native != std::endian::little);
      if (!(std::abs(value) < 1000.0F)) return false;
    }
  }
  return records.count > 0;
}

}  // namespace

PointRecords read_bin(std::span<const std::byte> file, int columns) {
  if (file.size() % row_bytes(columns) != 0) {
    throw Refusal(refusal_reason::wrong_size,
                  std::to_string(file.size()) + " bytes are no multiple of " +
                      std::to_string(row_bytes(columns)) + " (" + std::to_string(columns) +
                      " float32 columns); is the file cut, or another --bin-columns right?");
  }
  PointRecords records;
  for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i) {
    records.layout.fields.push_back(
        {column_name(i, columns), ScalarType::f32, i * sizeof(float), row_bytes(columns), 1});
  }
  records.count = file.size() / row_bytes(columns);
  records.bytes = file;
  return records;
}

std::variant<int, std::string> infer_bin_columns(const std::vector<std::uint64_t>& sizes,
                                                 std::span<const std::byte> sample) {
  std::vector<int> fitting;
  for (const int columns : common_columns) {
    if (divides_all(columns, sizes)) fitting.push_back(columns);
  }
  if (fitting.empty()) return "the sizes are no multiples of 16, 20 or 24 bytes";
  if (fitting.size() > 1) return "the sizes fit rows of several widths";
  if (!coordinates_are_plausible(sample, fitting[0])) {
    return "read as rows of " + std::to_string(fitting[0]) +
           " float32, coordinates are not finite or beyond 1 km";
  }
  return fitting[0];
}

}  // namespace kissmap
