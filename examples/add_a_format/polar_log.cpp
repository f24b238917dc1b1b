// SPDX-License-Identifier: MIT
// A made-up format, one file a scan, named by the microsecond at which the sweep began: six bytes
// "POLAR1", then records of twelve bytes, little-endian: u16 azimuth [0.01 deg, to the left], i16
// elevation [0.01 deg], u16 range [5 mm, 0 is no return], u16 intensity, u32 time [us].
#include "add_a_format/polar_log.hpp"

#include <cmath>
#include <cstring>
#include <numbers>

#include "formats/clouds/refusal.hpp"
#include "formats/datasets/dataset_folder.hpp"
#include "formats/text/lines.hpp"

namespace kissmap {
namespace {

constexpr std::string_view signature = "POLAR1";
constexpr std::size_t record_bytes = 12;
constexpr double radians = 0.01 * std::numbers::pi / 180.0;
constexpr float metres = 0.005F;

/// What of a record is handed on: columns by the names that the decoder of scans looks for.
struct Point {
  float x, y, z, intensity;
  std::uint32_t time;  // ns
};

template <class T>
T at(std::span<const std::byte> record, std::size_t offset) {
  T value{};
  std::memcpy(&value, record.data() + offset, sizeof(T));
  return value;
}

Point point_of(std::span<const std::byte> record) {
  const double azimuth = at<std::uint16_t>(record, 0) * radians;
  const double elevation = at<std::int16_t>(record, 2) * radians;
  const float range = at<std::uint16_t>(record, 4) * metres;
  const auto level = range * static_cast<float>(std::cos(elevation));
  return {level * static_cast<float>(std::cos(azimuth)),
          level * static_cast<float>(std::sin(azimuth)),
          range * static_cast<float>(std::sin(elevation)),
          static_cast<float>(at<std::uint16_t>(record, 6)),
          at<std::uint32_t>(record, 8) * 1000U};
}

PointRecords read_polar(std::span<const std::byte> file, std::int64_t /*stamp_ns*/) {
  if (!text_of(file).starts_with(signature)) {
    throw Refusal(refusal_reason::wrong_kind, "does not begin with POLAR1");
  }
  const auto content = file.subspan(signature.size());
  if (content.size() % record_bytes != 0) {
    throw Refusal(refusal_reason::truncated, "ends inside of a record; copy it anew");
  }
  PointRecords records;
  records.count = content.size() / record_bytes;
  records.storage.resize(records.count * sizeof(Point));
  for (std::size_t i = 0; i < records.count; ++i) {
    const Point point = point_of(content.subspan(i * record_bytes, record_bytes));
    std::memcpy(records.storage.data() + i * sizeof(Point), &point, sizeof(Point));
  }
  constexpr std::size_t stride = sizeof(Point);
  records.layout.byte_order = std::endian::native;
  records.layout.fields = {{"x", ScalarType::f32, offsetof(Point, x), stride, 1},
                           {"y", ScalarType::f32, offsetof(Point, y), stride, 1},
                           {"z", ScalarType::f32, offsetof(Point, z), stride, 1},
                           {"intensity", ScalarType::f32, offsetof(Point, intensity), stride, 1},
                           {"t", ScalarType::u32, offsetof(Point, time), stride, 1}};
  records.bytes = records.storage;
  return records;
}

}  // namespace

bool probe_polar(const std::filesystem::path& path) {
  return has_stamped_files(path, ".polar");
}

std::unique_ptr<ScanLog> open_polar(const std::filesystem::path& path, const ReadOptions& options) {
  DatasetScans set;
  set.format = "polar";
  set.path = path;
  set.clouds = path;
  set.extension = ".polar";
  set.sensor = "Polar P1";
  set.stamp_instant = StampInstant::sweep_start;
  set.compensation = Compensation::no;
  set.stamp_of = stamp_of_name;
  set.read = read_polar;
  return open_dataset(std::move(set), options);
}

}  // namespace kissmap
