// SPDX-License-Identifier: MIT
#include "formats/session/pack_columns.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "kissmap/cloud/scan.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pack.hpp"

namespace kissmap {
namespace {

enum class Encoding : std::uint8_t { none = 0, steps = 1, palette = 2, raw = 3 };

constexpr double direction_steps = 1e4;  // steps of 1e-4: at most 0.87e-4 rad off
constexpr std::size_t max_palette = 1 << 16;

using Steps = Eigen::Array3i;

Eigen::Vector3f point_from_steps(const Steps& steps) {
  return (steps.cast<double>() * pack_resolution).cast<float>().matrix();
}

// Rounding must not turn a return into "no return", nor into damage.
Steps steps_from_point(const Eigen::Vector3f& point) {
  Steps steps = (point.cast<double>().array() / pack_resolution).round().cast<int>();
  Eigen::Index axis = 0;
  point.cwiseAbs().maxCoeff(&axis);
  const int outward = point[axis] < 0.0F ? -1 : 1;
  if ((steps == 0).all()) steps[axis] = outward;
  while (point_from_steps(steps).norm() > max_plausible_range) steps[axis] -= outward;
  return steps;
}

std::vector<std::uint32_t> float_bits(const std::vector<float>& values) {
  std::vector<std::uint32_t> bits(values.size());
  std::ranges::transform(
      values, bits.begin(), [](float v) { return std::bit_cast<std::uint32_t>(v); });
  return bits;
}

std::vector<float> floats_from_bits(const std::vector<std::uint32_t>& bits) {
  std::vector<float> values(bits.size());
  std::ranges::transform(
      bits, values.begin(), [](std::uint32_t b) { return std::bit_cast<float>(b); });
  return values;
}

Encoding read_encoding(ByteReader& bytes) {
  const auto code = bytes.value<std::uint8_t>();
  if (code > 3) throw DamagedPack("a column has an unknown encoding");
  return static_cast<Encoding>(code);
}

void write_encoding(ByteWriter& bytes, Encoding encoding) {
  bytes.value(static_cast<std::uint8_t>(encoding));
}

void encode_palette(ByteWriter& bytes,
                    const std::vector<std::uint32_t>& bits,
                    const std::vector<std::uint32_t>& palette) {
  bytes.value(static_cast<std::uint32_t>(palette.size()));
  bytes.planes(palette);
  std::vector<std::uint16_t> places(bits.size());
  std::ranges::transform(bits, places.begin(), [&](std::uint32_t value) {
    return static_cast<std::uint16_t>(std::ranges::lower_bound(palette, value) - palette.begin());
  });
  bytes.planes(places, palette.size() > 256 ? 2 : 1);
}

std::vector<std::uint32_t> decode_palette(ByteReader& bytes, std::size_t size) {
  const auto count = bytes.value<std::uint32_t>();
  if (count > max_palette) throw DamagedPack("the intensity palette is too large");
  const auto palette = bytes.planes<std::uint32_t>(count);
  const auto places = bytes.planes<std::uint16_t>(size, count > 256 ? 2 : 1);
  std::vector<std::uint32_t> bits(size);
  std::ranges::transform(places, bits.begin(), [&](std::uint16_t place) {
    if (place >= palette.size()) throw DamagedPack("an intensity is outside its palette");
    return palette[place];
  });
  return bits;
}

std::vector<std::uint32_t> distinct(std::vector<std::uint32_t> values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

}  // namespace

void encode_points(ByteWriter& bytes, const std::vector<Eigen::Vector3f>& points) {
  std::array<std::vector<std::uint32_t>, 3> axes;
  for (auto& axis : axes) axis.reserve(points.size());
  for (const Eigen::Vector3f& point : points) {
    const Steps steps = steps_from_point(point);
    for (int i = 0; i < 3; ++i) {
      axes[static_cast<std::size_t>(i)].push_back(static_cast<std::uint32_t>(steps[i]));
    }
  }
  for (auto& axis : axes) bytes.difference_planes(std::move(axis));
}

std::vector<Eigen::Vector3f> decode_points(ByteReader& bytes, std::size_t size) {
  const auto x = bytes.difference_planes<std::uint32_t>(size);
  const auto y = bytes.difference_planes<std::uint32_t>(size);
  const auto z = bytes.difference_planes<std::uint32_t>(size);
  std::vector<Eigen::Vector3f> points(size);
  for (std::size_t i = 0; i < size; ++i) {
    points[i] =
        point_from_steps({static_cast<int>(x[i]), static_cast<int>(y[i]), static_cast<int>(z[i])});
  }
  return points;
}

void encode_directions(ByteWriter& bytes, const std::vector<Eigen::Vector3f>& directions) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::uint16_t> steps;
    steps.reserve(directions.size());
    for (const Eigen::Vector3f& direction : directions) {
      if (!(std::abs(direction.norm() - 1.0F) < 1e-3F)) {
        throw Error(Fault::internal, "a no-return direction is not of unit length");
      }
      const long rounded = std::lround(static_cast<double>(direction[axis]) * direction_steps);
      steps.push_back(static_cast<std::uint16_t>(rounded));
    }
    bytes.difference_planes(std::move(steps));
  }
}

std::vector<Eigen::Vector3f> decode_directions(ByteReader& bytes, std::size_t size) {
  const auto x = bytes.difference_planes<std::uint16_t>(size);
  const auto y = bytes.difference_planes<std::uint16_t>(size);
  const auto z = bytes.difference_planes<std::uint16_t>(size);
  std::vector<Eigen::Vector3f> directions(size);
  for (std::size_t i = 0; i < size; ++i) {
    const Eigen::Vector3d steps(static_cast<std::int16_t>(x[i]),
                                static_cast<std::int16_t>(y[i]),
                                static_cast<std::int16_t>(z[i]));
    if (steps.isZero(0.0)) throw DamagedPack("a no-return direction has no length");
    directions[i] = steps.normalized().cast<float>();
  }
  return directions;
}

void encode_times(ByteWriter& bytes, const std::vector<float>& times) {
  constexpr double ns_per_s = 1e9;
  constexpr float max_seconds = 2.1F;  // what an int32 of nanoseconds holds, and a little less
  if (times.empty()) return write_encoding(bytes, Encoding::none);
  if (std::ranges::any_of(times, [](float t) { return !(std::abs(t) <= max_seconds); })) {
    write_encoding(bytes, Encoding::raw);
    return bytes.planes(float_bits(times));
  }
  std::vector<std::uint32_t> nanoseconds(times.size());
  std::ranges::transform(times, nanoseconds.begin(), [](float t) {
    return static_cast<std::uint32_t>(
        static_cast<std::int32_t>(std::lround(static_cast<double>(t) * ns_per_s)));
  });
  write_encoding(bytes, Encoding::steps);
  bytes.difference_planes(std::move(nanoseconds));
}

std::vector<float> decode_times(ByteReader& bytes, std::size_t size) {
  const Encoding encoding = read_encoding(bytes);
  if (encoding == Encoding::none) return {};
  if (encoding == Encoding::raw) return floats_from_bits(bytes.planes<std::uint32_t>(size));
  if (encoding != Encoding::steps) throw DamagedPack("times have an unknown encoding");
  const auto nanoseconds = bytes.difference_planes<std::uint32_t>(size);
  std::vector<float> times(size);
  std::ranges::transform(nanoseconds, times.begin(), [](std::uint32_t ns) {
    return static_cast<float>(static_cast<std::int32_t>(ns) / 1e9);
  });
  return times;
}

void encode_intensities(ByteWriter& bytes, const std::vector<float>& intensities) {
  if (intensities.empty()) return write_encoding(bytes, Encoding::none);
  const std::vector<std::uint32_t> bits = float_bits(intensities);
  const std::vector<std::uint32_t> palette = distinct(bits);
  if (palette.size() > max_palette) {
    write_encoding(bytes, Encoding::raw);
    return bytes.planes(bits);
  }
  write_encoding(bytes, Encoding::palette);
  encode_palette(bytes, bits, palette);
}

std::vector<float> decode_intensities(ByteReader& bytes, std::size_t size) {
  const Encoding encoding = read_encoding(bytes);
  if (encoding == Encoding::none) return {};
  if (encoding == Encoding::raw) return floats_from_bits(bytes.planes<std::uint32_t>(size));
  if (encoding != Encoding::palette) throw DamagedPack("intensities have an unknown encoding");
  return floats_from_bits(decode_palette(bytes, size));
}

}  // namespace kissmap
