// SPDX-License-Identifier: MIT
// Writes Velodyne's data packets as their manuals lay them out.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kissmap::test {

class VelodynePacket {
 public:
  static constexpr std::size_t blocks = 12;
  static constexpr std::size_t shots = 32;

  VelodynePacket(unsigned product, unsigned mode, std::uint32_t us_past_hour) : bytes_(1206) {
    for (std::size_t block = 0; block < blocks; ++block) mark(block, 0xEEFF);
    for (std::size_t i = 0; i < 4; ++i) put(1200 + i, us_past_hour >> (8 * i));
    put(1204, mode);
    put(1205, product);
  }

  VelodynePacket& mark(std::size_t block, unsigned value) { return put16(block * 100, value); }
  /// In hundredths of a degree.
  VelodynePacket& azimuth(std::size_t block, long steps) {
    return put16(block * 100 + 2, static_cast<unsigned long>(steps % 36000));
  }
  VelodynePacket& azimuths(long steps) {
    for (std::size_t block = 0; block < blocks; ++block) azimuth(block, steps);
    return *this;
  }
  VelodynePacket& shot(std::size_t block, std::size_t shot, unsigned distance, unsigned intensity) {
    const std::size_t at = block * 100 + 4 + shot * 3;
    put(at + 2, intensity);
    return put16(at, distance);
  }
  VelodynePacket& all_shots(unsigned distance) {
    for (std::size_t block = 0; block < blocks; ++block) {
      for (std::size_t i = 0; i < shots; ++i) shot(block, i, distance, 7);
    }
    return *this;
  }
  std::vector<std::byte> bytes() const { return bytes_; }

 private:
  void put(std::size_t at, unsigned long value) {
    bytes_[at] = static_cast<std::byte>(value & 255U);
  }
  VelodynePacket& put16(std::size_t at, unsigned long value) {
    put(at, value);
    put(at + 1, value >> 8);
    return *this;
  }

  std::vector<std::byte> bytes_;
};

}  // namespace kissmap::test
