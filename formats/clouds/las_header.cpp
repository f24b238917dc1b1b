// SPDX-License-Identifier: MIT
#include "formats/clouds/las_header.hpp"

#include <algorithm>
#include <limits>
#include <string_view>
#include <vector>

#include "formats/clouds/point_columns.hpp"
#include "kissmap/version.hpp"

namespace kissmap {
namespace {

constexpr std::uint64_t most_legacy_points = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t extra_bytes_descriptor_size = 192;

struct ExtraBytes {
  std::uint8_t type;  // 5: u32, 9: float, 10: double
  std::string_view name;
  std::string_view meaning;
};
constexpr std::uint8_t extra_u32 = 5;
constexpr std::uint8_t extra_f32 = 9;
constexpr std::uint8_t extra_f64 = 10;

std::vector<ExtraBytes> extra_bytes(const CloudFields& fields) {
  std::vector<ExtraBytes> all;
  const auto add = [&all](std::initializer_list<ExtraBytes> more) { all.insert(all.end(), more); };
  if (fields.normals) {
    add({{extra_f32, "normal_x", "unit normal"},
         {extra_f32, "normal_y", "unit normal"},
         {extra_f32, "normal_z", "unit normal"}});
  }
  if (fields.scan) add({{extra_u32, "scan", "index of the scan"}});
  if (fields.sensor) {
    add({{extra_f64, "sensor_x", "sensor when it saw this [m]"},
         {extra_f64, "sensor_y", "sensor when it saw this [m]"},
         {extra_f64, "sensor_z", "sensor when it saw this [m]"}});
  }
  return all;
}

void append_padded(std::string_view text, std::size_t size, std::string& bytes) {
  bytes.append(text.substr(0, size));
  bytes.append(size - std::min(size, text.size()), '\0');
}

std::string extra_bytes_record(const std::vector<ExtraBytes>& all) {
  if (all.empty()) return {};
  std::string record;
  append_value<std::uint16_t>(0, record);
  append_padded("LASF_Spec", 16, record);
  append_value<std::uint16_t>(4, record);
  append_value(static_cast<std::uint16_t>(all.size() * extra_bytes_descriptor_size), record);
  append_padded("extra bytes", 32, record);
  for (const ExtraBytes& extra : all) {
    append_value<std::uint16_t>(0, record);
    append_value(extra.type, record);
    append_value<std::uint8_t>(0, record);  // no minimum, maximum, scale or offset
    append_padded(extra.name, 32, record);
    append_padded({}, 124, record);
    append_padded(extra.meaning, 32, record);
  }
  return record;
}

std::uint8_t point_format(const CloudFields& fields) {
  return static_cast<std::uint8_t>((fields.time ? 1 : 0) + (fields.rgb ? 2 : 0));
}

void append_bounds(const CloudWriterOptions& options,
                   const LasContent& content,
                   std::string& bytes) {
  for (int axis = 0; axis < 3; ++axis) append_value(las_scale, bytes);
  for (int axis = 0; axis < 3; ++axis) append_value(options.offset[axis], bytes);
  for (int axis = 0; axis < 3; ++axis) {
    append_value(content.high[axis] * las_scale + options.offset[axis], bytes);
    append_value(content.low[axis] * las_scale + options.offset[axis], bytes);
  }
}

// All points are the only return of their shot. A number that 32 bits do not hold stands at the end
// of the header alone, and 0 here.
void append_legacy_counts(std::uint64_t points, std::string& bytes) {
  const auto count = static_cast<std::uint32_t>(points > most_legacy_points ? 0 : points);
  append_value(count, bytes);
  append_value(count, bytes);
  append_padded({}, 4 * sizeof(std::uint32_t), bytes);
}

void append_wide_counts(std::uint64_t points, std::string& bytes) {
  append_padded({}, 8 + 8 + 4, bytes);  // no waveforms, no extended records
  append_value(points, bytes);
  append_value(points, bytes);
  append_padded({}, 14 * sizeof(std::uint64_t), bytes);
}

}  // namespace

std::uint16_t las_record_size(const CloudFields& fields) {
  std::size_t size = 20 + (fields.time ? 8 : 0) + (fields.rgb ? 6 : 0);
  for (const ExtraBytes& extra : extra_bytes(fields)) size += extra.type == extra_f64 ? 8 : 4;
  return static_cast<std::uint16_t>(size);
}

std::string las_header(const CloudWriterOptions& options, const LasContent& content) {
  const bool wide = options.most_points > most_legacy_points;
  const std::uint16_t header_size = wide ? 375 : 227;
  const std::string records = extra_bytes_record(extra_bytes(options.fields));
  std::string bytes = "LASF";
  append_value<std::uint16_t>(0, bytes);                          // file source
  append_value<std::uint16_t>(options.unix_time ? 1 : 0, bytes);  // bit 0: see las_time
  append_padded({}, 16, bytes);                                   // no project id
  append_value<std::uint8_t>(1, bytes);
  append_value<std::uint8_t>(wide ? 4 : 2, bytes);
  append_padded("EXTRACTION", 32, bytes);
  append_padded(std::string("kissmap ") + version(), 32, bytes);
  append_value<std::uint16_t>(0, bytes);  // no date: the same map gives the same bytes
  append_value<std::uint16_t>(0, bytes);
  append_value(header_size, bytes);
  append_value(static_cast<std::uint32_t>(header_size + records.size()), bytes);
  append_value<std::uint32_t>(records.empty() ? 0 : 1, bytes);
  append_value(point_format(options.fields), bytes);
  append_value(las_record_size(options.fields), bytes);
  append_legacy_counts(content.points, bytes);
  append_bounds(options, content, bytes);
  if (wide) append_wide_counts(content.points, bytes);
  return bytes + records;
}

}  // namespace kissmap
