// SPDX-License-Identifier: MIT
// Writes Hesai's data packets as their manuals lay them out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace kissmap::test {

/// Where the numbers of a kind of packet stand.
struct HesaiKind {
  const char* sensor = "";
  std::size_t lasers = 0, blocks = 0;
  std::size_t header = 0;        ///< bytes before the first block
  std::size_t before_shots = 0;  ///< bytes of a block before its shots, the azimuth last
  std::size_t shot = 0;          ///< bytes
  std::size_t tail = 0;          ///< where it begins
  std::size_t mode = 0, speed = 0, date = 0, microseconds = 0;  ///< in the tail
  std::size_t size = 0;
  std::vector<unsigned> first;  ///< bytes of the header, or of each block
};

inline const HesaiKind xt_32_kind{"Hesai PandarXT-32",
                                  32,
                                  8,
                                  12,
                                  2,
                                  4,
                                  1052,
                                  10,
                                  11,
                                  13,
                                  19,
                                  1080,
                                  {0xEE, 0xFF, 6, 1, 0, 0, 32, 8, 1, 4, 2, 1}};
inline const HesaiKind xt_16_kind{"Hesai PandarXT-16",
                                  16,
                                  8,
                                  12,
                                  2,
                                  4,
                                  540,
                                  10,
                                  11,
                                  13,
                                  19,
                                  568,
                                  {0xEE, 0xFF, 6, 1, 0, 0, 16, 8, 1, 4, 2, 1}};
inline const HesaiKind xt_32m_kind{"Hesai XT32M2X",
                                   32,
                                   6,
                                   12,
                                   2,
                                   4,
                                   792,
                                   10,
                                   11,
                                   13,
                                   19,
                                   820,
                                   {0xEE, 0xFF, 6, 1, 0, 0, 32, 6, 1, 4, 2, 1}};
inline const HesaiKind qt_128_kind{"Hesai QT128C2X",
                                   128,
                                   2,
                                   12,
                                   2,
                                   4,
                                   1061,
                                   12,
                                   13,
                                   15,
                                   21,
                                   1127,
                                   {0xEE, 0xFF, 3, 2, 0, 0, 128, 2, 1, 4, 2, 0x1D}};
inline const HesaiKind pandar_64_kind{
    "Hesai Pandar64", 64, 6, 8, 2, 3, 1172, 14, 8, 16, 10, 1198, {0xEE, 0xFF, 64, 6, 0, 4, 0, 0}};
inline const HesaiKind pandar_40p_kind{
    "Hesai Pandar40P", 40, 10, 0, 4, 3, 1240, 14, 8, 16, 10, 1262, {0xFF, 0xEE}};

class HesaiPacketBytes {
 public:
  HesaiPacketBytes(const HesaiKind& kind, unsigned mode) : kind_(&kind), bytes_(kind.size) {
    const std::size_t marked = kind.header > 0 ? 1 : kind.blocks;
    for (std::size_t block = 0; block < marked; ++block) {
      for (std::size_t i = 0; i < kind.first.size(); ++i)
        put(block_at(block) - kind.header + i, kind.first[i]);
    }
    put(kind.tail + kind.mode, mode);
    date({123, 11, 14, 22, 13, 20});  // 1700000000 s
  }

  HesaiPacketBytes& put(std::size_t at, unsigned long value) {
    bytes_.at(at) = static_cast<std::byte>(value & 255U);
    return *this;
  }
  HesaiPacketBytes& put16(std::size_t at, unsigned long value) {
    return put(at, value).put(at + 1, value >> 8);
  }
  HesaiPacketBytes& azimuth(std::size_t block, long steps) {
    return put16(block_at(block) + kind_->before_shots - 2,
                 static_cast<unsigned long>(steps % 36000));
  }
  HesaiPacketBytes& shot(std::size_t block, std::size_t laser, unsigned distance, unsigned bright) {
    const std::size_t at = block_at(block) + kind_->before_shots + laser * kind_->shot;
    return put16(at, distance).put(at + 2, bright);
  }
  HesaiPacketBytes& all_shots(unsigned distance) {
    for (std::size_t i = 0; i < kind_->blocks * kind_->lasers; ++i) {
      shot(i / kind_->lasers, i % kind_->lasers, distance, 7);
    }
    return *this;
  }
  HesaiPacketBytes& speed(unsigned turns_per_minute) {
    return put16(kind_->tail + kind_->speed, turns_per_minute);
  }
  HesaiPacketBytes& date(const std::array<unsigned, 6>& bytes) {
    for (std::size_t i = 0; i < bytes.size(); ++i) put(kind_->tail + kind_->date + i, bytes[i]);
    return *this;
  }
  HesaiPacketBytes& microseconds(unsigned long us) {
    const std::size_t at = kind_->tail + kind_->microseconds;
    return put16(at, us).put16(at + 2, us >> 16);
  }
  std::vector<std::byte> bytes() const { return bytes_; }

 private:
  std::size_t block_at(std::size_t block) const {
    return kind_->header + block * (kind_->before_shots + kind_->lasers * kind_->shot);
  }

  const HesaiKind* kind_;
  std::vector<std::byte> bytes_;
};

}  // namespace kissmap::test
