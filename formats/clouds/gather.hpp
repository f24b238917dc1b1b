// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "formats/clouds/record_layout.hpp"

namespace kissmap {

/// Copies `count` values that lie `stride` bytes apart. From 64-bit integers `base` is subtracted
/// first, so that a double keeps their last digits; others ignore it.
template <class Out>
using Gather = void (*)(
    const std::byte* first, std::size_t stride, std::size_t count, std::int64_t base, Out* out);

namespace gather_detail {

template <class T>
T swapped(T value) {
  if constexpr (sizeof(T) == 1) return value;
  if constexpr (sizeof(T) == 2) {
    return std::bit_cast<T>(__builtin_bswap16(std::bit_cast<std::uint16_t>(value)));
  }
  if constexpr (sizeof(T) == 4) {
    return std::bit_cast<T>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
  }
  if constexpr (sizeof(T) == 8) {
    return std::bit_cast<T>(__builtin_bswap64(std::bit_cast<std::uint64_t>(value)));
  }
}

template <class T>
T load(const std::byte* from, bool swap) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return swap ? swapped(value) : value;
}

template <class Out, class T>
Out converted(T value, std::int64_t base) {
  if constexpr (std::integral<T> && sizeof(T) == 8) {
    const auto difference = static_cast<std::uint64_t>(value) - static_cast<std::uint64_t>(base);
    return static_cast<Out>(static_cast<std::int64_t>(difference));
  } else if constexpr (std::same_as<T, double> && std::same_as<Out, float>) {
    // Beyond the range of float the conversion is undefined; such a coordinate is damage anyway.
    return static_cast<float>(std::isfinite(value) ? std::clamp(value, -1e30, 1e30) : value);
  } else {
    return static_cast<Out>(value);
  }
}

template <class Out, class T, bool swap>
void gather(
    const std::byte* first, std::size_t stride, std::size_t count, std::int64_t base, Out* out) {
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = converted<Out>(load<T>(first + i * stride, swap), base);
  }
}

template <class Out, class T>
Gather<Out> gather_of(std::endian order) {
  return order == std::endian::native ? &gather<Out, T, false> : &gather<Out, T, true>;
}

}  // namespace gather_detail

template <class Out>
Gather<Out> gather_for(ScalarType type, std::endian order) {
  using namespace gather_detail;
  switch (type) {
    case ScalarType::i8:
      return gather_of<Out, std::int8_t>(order);
    case ScalarType::u8:
      return gather_of<Out, std::uint8_t>(order);
    case ScalarType::i16:
      return gather_of<Out, std::int16_t>(order);
    case ScalarType::u16:
      return gather_of<Out, std::uint16_t>(order);
    case ScalarType::i32:
      return gather_of<Out, std::int32_t>(order);
    case ScalarType::u32:
      return gather_of<Out, std::uint32_t>(order);
    case ScalarType::i64:
      return gather_of<Out, std::int64_t>(order);
    case ScalarType::u64:
      return gather_of<Out, std::uint64_t>(order);
    case ScalarType::f32:
      return gather_of<Out, float>(order);
    case ScalarType::f64:
      break;
  }
  return gather_of<Out, double>(order);
}

}  // namespace kissmap
