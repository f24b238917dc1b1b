// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

namespace kissmap {

/// Numbers out of a payload. A read beyond its end throws std::out_of_range: decoders compare the
/// length with the layout first, so that would be a mistake of theirs, not of the input.
class PacketBytes {
 public:
  explicit PacketBytes(std::span<const std::byte> payload) : payload_(payload) {}

  std::size_t size() const { return payload_.size(); }
  std::span<const std::byte> payload() const { return payload_; }

  std::uint8_t u8(std::size_t at) const {
    if (at >= payload_.size()) throw std::out_of_range("read beyond the end of a packet");
    return std::to_integer<std::uint8_t>(payload_[at]);
  }
  /// Least significant byte first.
  std::uint16_t u16(std::size_t at) const {
    return static_cast<std::uint16_t>(u8(at) | (u8(at + 1) << 8));
  }
  std::uint32_t u32(std::size_t at) const {
    return u16(at) | (static_cast<std::uint32_t>(u16(at + 2)) << 16);
  }
  /// Most significant byte first.
  std::uint32_t u32_big(std::size_t at) const {
    return (static_cast<std::uint32_t>(u8(at)) << 24) |
           (static_cast<std::uint32_t>(u8(at + 1)) << 16) |
           (static_cast<std::uint32_t>(u8(at + 2)) << 8) | u8(at + 3);
  }

 private:
  std::span<const std::byte> payload_;
};

/// A packet that may have to stay: its bytes are copied once, when that is first asked for.
class KeptPacket {
 public:
  explicit KeptPacket(const PacketBytes& bytes) : bytes_(bytes) {}

  const PacketBytes& bytes() const { return bytes_; }
  std::shared_ptr<const std::vector<std::byte>> copy() {
    const auto payload = bytes_.payload();
    if (!copy_) copy_ = std::make_shared<std::vector<std::byte>>(payload.begin(), payload.end());
    return copy_;
  }

 private:
  PacketBytes bytes_;
  std::shared_ptr<const std::vector<std::byte>> copy_;
};

}  // namespace kissmap
