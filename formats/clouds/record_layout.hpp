// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace kissmap {

enum class ScalarType : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

constexpr std::size_t size_of(ScalarType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

/// A named column of numbers. Value v of point i begins at byte offset + i * stride + v * size.
/// Packed records have one stride in common; planes have the size of their values.
struct RecordField {
  std::string name;
  ScalarType type = ScalarType::f32;
  std::size_t offset = 0;
  std::size_t stride = 0;
  std::size_t count = 1;  ///< values per point
};

struct RecordLayout {
  std::vector<RecordField> fields;
  std::endian byte_order = std::endian::little;
};

/// Points as a file stores them. `bytes` points into `storage` or into a buffer of the caller's.
struct PointRecords {
  RecordLayout layout;
  std::size_t count = 0;
  std::span<const std::byte> bytes;
  std::vector<std::byte> storage;

  PointRecords() = default;
  PointRecords(PointRecords&&) = default;
  PointRecords& operator=(PointRecords&&) = default;
};

}  // namespace kissmap
