// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kissmap {

static_assert(std::endian::native == std::endian::little, "packed without swapping bytes");

/// Bytes of a pack that contradict its layout. The reader adds file and place.
class DamagedPack : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Maps small numbers of either sign to small unsigned ones: 0, -1, 1, -2 -> 0, 1, 2, 3.
/// Differences wrap around, so that every pair of values has one.
template <typename Unsigned>
Unsigned zigzag_difference(Unsigned value, Unsigned before) {
  const auto difference = static_cast<Unsigned>(value - before);
  const bool negative = difference >> (8 * sizeof(Unsigned) - 1) != 0;
  const auto doubled = static_cast<Unsigned>(difference << 1);
  return negative ? static_cast<Unsigned>(~doubled) : doubled;
}

template <typename Unsigned>
Unsigned undo_zigzag_difference(Unsigned code, Unsigned before) {
  const auto half = static_cast<Unsigned>(code >> 1);
  return static_cast<Unsigned>(before + ((code & 1) != 0 ? static_cast<Unsigned>(~half) : half));
}

/// Appends little-endian values.
class ByteWriter {
 public:
  template <typename Value>
  void value(Value number) {
    static_assert(std::is_arithmetic_v<Value>);
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }

  void text(std::string_view characters) {
    value(static_cast<std::uint32_t>(characters.size()));
    bytes_ += characters;
  }

  /// Byte 0 of all values, then byte 1 of all values, ...
  template <typename Unsigned>
  void planes(const std::vector<Unsigned>& values, std::size_t count = sizeof(Unsigned)) {
    std::size_t at = bytes_.size();
    bytes_.resize(at + count * values.size());
    for (std::size_t plane = 0; plane < count; ++plane) {
      for (const Unsigned number : values) bytes_[at++] = static_cast<char>(number >> (8 * plane));
    }
  }

  template <typename Unsigned>
  void difference_planes(std::vector<Unsigned> values) {
    Unsigned before = 0;
    for (Unsigned& number : values) {
      const Unsigned current = number;
      number = zigzag_difference(current, before);
      before = current;
    }
    planes(values);
  }

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Takes values from the front; throws DamagedPack rather than read past the end, and before
/// memory is asked for that the bytes could not fill.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Value>
  Value value() {
    Value number{};
    std::memcpy(&number, take(sizeof number).data(), sizeof number);
    return number;
  }

  std::string text() { return std::string(take(value<std::uint32_t>())); }

  template <typename Unsigned>
  std::vector<Unsigned> planes(std::size_t size, std::size_t count = sizeof(Unsigned)) {
    if (size > bytes_.size() / count) throw DamagedPack("the scan ends early");
    std::vector<Unsigned> values(size, 0);
    for (std::size_t plane = 0; plane < count; ++plane) {
      const std::string_view bytes = take(size);
      for (std::size_t i = 0; i < size; ++i) {
        const auto byte = static_cast<unsigned char>(bytes[i]);
        values[i] = static_cast<Unsigned>(values[i] | (static_cast<Unsigned>(byte) << (8 * plane)));
      }
    }
    return values;
  }

  template <typename Unsigned>
  std::vector<Unsigned> difference_planes(std::size_t size) {
    std::vector<Unsigned> values = planes<Unsigned>(size);
    Unsigned before = 0;
    for (Unsigned& number : values) number = before = undo_zigzag_difference(number, before);
    return values;
  }

  void end() const {
    if (!bytes_.empty()) throw DamagedPack("bytes are left over at the end of the scan");
  }

 private:
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw DamagedPack("the scan ends early");
    const std::string_view front = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return front;
  }

  std::string_view bytes_;
};

}  // namespace kissmap
