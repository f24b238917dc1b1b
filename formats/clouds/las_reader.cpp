// SPDX-License-Identifier: MIT
#include "formats/clouds/las_reader.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include "formats/clouds/refusal.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

constexpr std::size_t least_header = 227;
constexpr std::size_t header_of_14 = 375;
constexpr std::uint8_t most_format = 10;
constexpr std::uint8_t compressed_bits = 0xC0;  // of the format, set by LASzip
// Of formats 0 to 10: the least size of a record, and where its time lies.
constexpr std::size_t least_record[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::size_t time_at[] = {0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22};

template <class T>
T at(std::span<const std::byte> file, std::size_t offset) {
  T value;
  std::memcpy(&value, file.data() + offset, sizeof(T));
  return value;
}

struct LasHeader {
  std::size_t data_offset = 0;
  std::uint8_t format = 0;
  std::size_t record = 0;
  std::uint64_t count = 0;
  double scale[3] = {};
  double offset[3] = {};
};

LasHeader read_header(std::span<const std::byte> file) {
  if (!text_of(file).starts_with("LASF"))
    throw Refusal(refusal_reason::wrong_kind, "not a LAS file");
  if (file.size() < least_header) throw Refusal(refusal_reason::truncated, "it ends in its header");
  LasHeader header;
  const auto minor = at<std::uint8_t>(file, 25);
  header.data_offset = at<std::uint32_t>(file, 96);
  header.format = at<std::uint8_t>(file, 104);
  header.record = at<std::uint16_t>(file, 105);
  header.count = at<std::uint32_t>(file, 107);
  if (minor >= 4 && file.size() >= header_of_14 && header.count == 0) {
    header.count = at<std::uint64_t>(file, 247);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    header.scale[axis] = at<double>(file, 131 + 8 * axis);
    header.offset[axis] = at<double>(file, 155 + 8 * axis);
    if (!std::isfinite(header.scale[axis]) || !std::isfinite(header.offset[axis])) {
      throw Refusal(refusal_reason::broken_header, "scale or offset is not finite");
    }
  }
  return header;
}

void require_readable(const LasHeader& header, std::size_t size) {
  if ((header.format & compressed_bits) != 0) {
    throw Refusal(refusal_reason::unsupported,
                  "compressed (LAZ); unpack it, for example with 'pdal translate'");
  }
  if (header.format > most_format) {
    throw Refusal(refusal_reason::unsupported,
                  "point format " + std::to_string(header.format) + "; 0 to 10 are read");
  }
  if (header.record < least_record[header.format]) {
    throw Refusal(refusal_reason::broken_header,
                  "records of " + std::to_string(header.record) + " bytes in point format " +
                      std::to_string(header.format));
  }
  if (header.data_offset > size || header.count > (size - header.data_offset) / header.record) {
    throw Refusal(refusal_reason::truncated,
                  std::to_string(header.count) + " points of " + std::to_string(header.record) +
                      " bytes from byte " + std::to_string(header.data_offset) + " of " +
                      std::to_string(size));
  }
}

}  // namespace

PointRecords read_las(std::span<const std::byte> file) {
  const LasHeader header = read_header(file);
  require_readable(header, file.size());
  constexpr std::size_t columns = 5;
  constexpr const char* names[columns] = {"x", "y", "z", "intensity", "gps_time"};
  const bool timed = time_at[header.format] != 0;
  const std::size_t used = timed ? columns : columns - 1;
  PointRecords records;
  records.layout.byte_order = std::endian::native;
  for (std::size_t i = 0; i < used; ++i) {
    records.layout.fields.push_back(
        {names[i], ScalarType::f64, i * sizeof(double), used * sizeof(double), 1});
  }
  records.count = header.count;
  records.storage.resize(header.count * used * sizeof(double));
  for (std::uint64_t i = 0; i < header.count; ++i) {
    const std::size_t from = header.data_offset + i * header.record;
    double row[columns];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      row[axis] =
          at<std::int32_t>(file, from + 4 * axis) * header.scale[axis] + header.offset[axis];
    }
    row[3] = at<std::uint16_t>(file, from + 12);
    if (timed) row[4] = at<double>(file, from + time_at[header.format]);
    std::memcpy(records.storage.data() + i * used * sizeof(double), row, used * sizeof(double));
  }
  records.bytes = records.storage;
  return records;
}

}  // namespace kissmap
