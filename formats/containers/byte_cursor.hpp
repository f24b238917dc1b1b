// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "formats/clouds/refusal.hpp"

namespace kissmap {

static_assert(std::endian::native == std::endian::little);

/// Reads little-endian values one after the other. Every member throws Refusal where the bytes end.
class ByteCursor {
 public:
  explicit ByteCursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::size_t position() const { return position_; }
  std::size_t left() const { return bytes_.size() - position_; }

  template <class T>
  requires std::is_arithmetic_v<T> T value() {
    T result;
    std::memcpy(&result, take(sizeof(T)).data(), sizeof(T));
    return result;
  }

  std::span<const std::byte> take(std::uint64_t count) {
    if (count > left()) {
      throw Refusal(refusal_reason::truncated,
                    std::to_string(count) + " bytes wanted at byte " + std::to_string(position_) +
                        " of " + std::to_string(bytes_.size()));
    }
    const auto taken = bytes_.subspan(position_, static_cast<std::size_t>(count));
    position_ += taken.size();
    return taken;
  }

  /// A length of 32 bits, then as many bytes.
  std::span<const std::byte> block32() { return take(value<std::uint32_t>()); }

  std::string_view text32() {
    const auto bytes = block32();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

}  // namespace kissmap
