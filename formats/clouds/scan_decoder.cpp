// SPDX-License-Identifier: MIT
#include "formats/clouds/scan_decoder.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "formats/clouds/gather.hpp"
#include "formats/clouds/refusal.hpp"

namespace kissmap {
namespace {

constexpr std::size_t block_size = 512;  // points; all columns of a block stay in the L1 cache

/// A smaller scan does not settle in which unit a log writes time: its span may be tiny.
constexpr std::size_t min_points_to_settle = 100;

// Sweeps last 0.02 to 2 s; a part of one may be shorter.
constexpr float shortest_sweep = 0.005F;  // s

constexpr const char* intensity_names[] = {
    "intensity", "i", "intensities", "reflectance", "reflectivity", "remission"};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

// CloudCompare writes every extra column of a PLY as scalar_NAME.
std::string_view without_scalar_prefix(std::string_view name) {
  constexpr std::string_view prefix = "scalar_";
  return name.starts_with(prefix) ? name.substr(prefix.size()) : name;
}

const RecordField* find_field(const RecordLayout& layout, std::string_view name, bool any_case) {
  const auto matches = [&](const RecordField& field) {
    const std::string_view bare = without_scalar_prefix(field.name);
    return field.count == 1 && (bare == name || (any_case && lower(bare) == name));
  };
  const auto found = std::ranges::find_if(layout.fields, matches);
  return found == layout.fields.end() ? nullptr : &*found;
}

std::string names_of(const RecordLayout& layout) {
  std::string names;
  for (const RecordField& field : layout.fields) names += (names.empty() ? "" : " ") + field.name;
  return names.empty() ? "none" : names;
}

std::string described(const RecordLayout& layout) {
  constexpr const char* types[] = {
      "i8", "u8", "i16", "u16", "i32", "u32", "i64", "u64", "f32", "f64"};
  std::string text;
  for (const RecordField& field : layout.fields) {
    text +=
        (text.empty() ? "" : ", ") + field.name + " " + types[static_cast<std::size_t>(field.type)];
    if (field.count > 1) text += "[" + std::to_string(field.count) + "]";
  }
  return text;
}

const RecordField& coordinate(const RecordLayout& layout, const char* name) {
  if (const RecordField* field = find_field(layout, name, true)) return *field;
  throw Refusal(
      refusal_reason::no_coordinates,
      std::string("no field ") + name + " with one value per point; fields: " + names_of(layout));
}

const RecordField* intensity_field(const RecordLayout& layout) {
  for (const char* name : intensity_names) {
    if (const RecordField* field = find_field(layout, name, true)) return field;
  }
  return nullptr;
}

void require_inside(const PointRecords& records, const RecordField& field) {
  const std::size_t value_end = field.offset + size_of(field.type);
  const std::size_t size = records.bytes.size();
  if (records.count == 0) return;
  const bool first_inside = value_end >= field.offset && value_end <= size;
  const bool last_inside =
      records.count == 1 ||
      (first_inside && field.stride > 0 && records.count - 1 <= (size - value_end) / field.stride);
  if (!first_inside || !last_inside) {
    throw Refusal(refusal_reason::truncated,
                  "field " + field.name + " of " + std::to_string(records.count) +
                      " points reaches beyond the " + std::to_string(size) +
                      " bytes of point data");
  }
}

/// One field on its way out of the records, block by block.
template <class Out>
class Column {
 public:
  Column(const PointRecords& records, const RecordField* field, std::int64_t base = 0) {
    if (field == nullptr) return;
    require_inside(records, *field);
    gather_ = gather_for<Out>(field->type, records.layout.byte_order);
    first_ = records.bytes.data() + (records.count > 0 ? field->offset : 0);
    stride_ = field->stride;
    base_ = base;
  }
  bool present() const { return gather_ != nullptr; }
  Out operator[](std::size_t i) const { return block_[i]; }
  void load(std::size_t begin, std::size_t count) {
    if (gather_) gather_(first_ + begin * stride_, stride_, count, base_, block_.data());
  }

 private:
  Gather<Out> gather_ = nullptr;
  const std::byte* first_ = nullptr;
  std::size_t stride_ = 0;
  std::int64_t base_ = 0;
  std::array<Out, block_size> block_;
};

/// The reason to drop a point, as the counter to raise; nothing if it is a return.
std::uint64_t* drop_counter(const Eigen::Vector3f& point, DroppedReturns& dropped) {
  if (!point.allFinite()) return &dropped.non_finite;
  if (point.isZero(0.0F)) return &dropped.zero;
  if (point.squaredNorm() > max_plausible_range * max_plausible_range) return &dropped.implausible;
  return nullptr;
}

// Most points are returns: the comparison alone decides, and NaN fails it.
bool is_certain_return(const Eigen::Vector3f& point) {
  const float squared_range = point.squaredNorm();
  return squared_range > 0.0F && squared_range <= max_plausible_range * max_plausible_range;
}

void extract_returns(const PointRecords& records,
                     const RecordField* time,
                     Scan& scan,
                     RawTimes& times) {
  Column<float> x(records, &coordinate(records.layout, "x"));
  Column<float> y(records, &coordinate(records.layout, "y"));
  Column<float> z(records, &coordinate(records.layout, "z"));
  Column<float> intensity(records, intensity_field(records.layout));
  Column<double> t(records, time, times.base);
  scan.points.resize(records.count);
  scan.intensities.resize(intensity.present() ? records.count : 0);
  times.values.resize(t.present() ? records.count : 0);

  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < records.count; begin += block_size) {
    const std::size_t size = std::min(block_size, records.count - begin);
    for (Column<float>* column : {&x, &y, &z, &intensity}) column->load(begin, size);
    t.load(begin, size);
    for (std::size_t i = 0; i < size; ++i) {
      const Eigen::Vector3f point(x[i], y[i], z[i]);
      if (!is_certain_return(point)) {
        if (std::uint64_t* counter = drop_counter(point, scan.dropped)) {
          ++*counter;
          continue;
        }
      }
      scan.points[kept] = point;
      if (intensity.present()) scan.intensities[kept] = intensity[i];
      if (t.present()) times.values[kept] = t[i];
      ++kept;
    }
  }
  scan.points.resize(kept);
  scan.intensities.resize(intensity.present() ? kept : 0);
  times.values.resize(t.present() ? kept : 0);
}

// The first value serves as zero of 64-bit integers; any nearby number would.
std::int64_t base_of(const PointRecords& records, const RecordField& field) {
  const bool wide = field.type == ScalarType::i64 || field.type == ScalarType::u64;
  if (!wide || records.count == 0) return 0;
  require_inside(records, field);
  return gather_detail::load<std::int64_t>(records.bytes.data() + field.offset,
                                           records.layout.byte_order != std::endian::native);
}

void drop_points_without_time(Scan& scan) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!std::isfinite(scan.time_offsets[i])) continue;
    scan.points[kept] = scan.points[i];
    scan.time_offsets[kept] = scan.time_offsets[i];
    if (!scan.intensities.empty()) scan.intensities[kept] = scan.intensities[i];
    ++kept;
  }
  scan.dropped.non_finite += scan.points.size() - kept;
  scan.points.resize(kept);
  scan.time_offsets.resize(kept);
  scan.intensities.resize(scan.intensities.empty() ? 0 : kept);
}

}  // namespace

const RecordField* ScanDecoder::time_field(const RecordLayout& layout) const {
  if (options_.time_unit == "none") return nullptr;
  if (!options_.time_field.empty()) {
    if (const RecordField* field = find_field(layout, options_.time_field, false)) return field;
    throw Refusal(refusal_reason::no_time_field,
                  "no field " + options_.time_field + "; fields: " + names_of(layout));
  }
  for (const char* name : time_field_names) {
    const RecordField* field = find_field(layout, name, false);
    if (field != nullptr && size_of(field->type) >= 4) return field;
  }
  return nullptr;
}

void ScanDecoder::apply_times(const RecordField& field, const RawTimes& times, Scan& scan) {
  const auto reading = settled_ ? settled_ : find_time_reading(times, options_.time_unit);
  const auto sweep =
      reading ? times_from_stamp(times, *reading, scan.stamp_ns) : std::optional<SweepTimes>();
  if (!sweep) {
    time_note_ = "field " + field.name +
                 " holds no usable times: all equal, not finite, or spanning more than 2 s";
    return;
  }
  if (times.values.size() >= min_points_to_settle) settled_ = reading;
  time_note_ = "times of points: field " + field.name + ", " + describe(*reading);
  if (sweep->from_first_point) {
    time_note_ += ", on another clock than the stamps; the first point is taken to be at the stamp";
  }
  const auto [first, last] = std::ranges::minmax(sweep->offsets);
  if (last - first < shortest_sweep) {
    time_note_ +=
        "; they span only " + std::to_string(1e3F * (last - first)) + " ms: is --time-unit right?";
  }
  scan.time_offsets = sweep->offsets;
  scan.time_source = TimeSource::recorded;
  scan.stamp_instant = sweep->stamp_instant;
  drop_points_without_time(scan);
}

Scan ScanDecoder::decode(const PointRecords& records, std::int64_t stamp_ns) {
  Scan scan;
  scan.stamp_ns = stamp_ns;
  time_note_ = "no times of points";
  if (fields_.empty()) fields_ = described(records.layout);
  const RecordField* time = time_field(records.layout);
  RawTimes times;
  if (time != nullptr) {
    times.type = time->type;
    times.base = base_of(records, *time);
  }
  extract_returns(records, time, scan, times);
  if (time != nullptr) apply_times(*time, times, scan);
  return scan;
}

}  // namespace kissmap
