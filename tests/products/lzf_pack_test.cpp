// SPDX-License-Identifier: MIT
#include "formats/clouds/lzf_pack.hpp"

#include <gtest/gtest.h>
#include <liblzf/lzf.h>

#include <random>

namespace kissmap {
namespace {

std::string unpacked(const std::string& packed, std::size_t size) {
  std::string bytes(size + 1, '\0');  // liblzf wants a buffer even for nothing
  const unsigned length = packed.empty() ? 0
                                         : lzf_decompress(packed.data(),
                                                          static_cast<unsigned>(packed.size()),
                                                          bytes.data(),
                                                          static_cast<unsigned>(size));
  bytes.resize(length);
  return bytes;
}

std::string packed(const std::string& bytes) {
  std::string result;
  append_lzf(bytes, result);
  return result;
}

/// Runs of random letters out of a few, so that matches of all lengths and distances occur.
std::string text(std::size_t size, int letters, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes;
  while (bytes.size() < size) {
    if (!bytes.empty() && random() % 3 == 0) {
      const std::size_t back = 1 + random() % std::min<std::size_t>(bytes.size(), 20000);
      const std::size_t length = 1 + random() % 600;
      for (std::size_t i = 0; i < length; ++i) bytes += bytes[bytes.size() - back];
    } else {
      bytes += static_cast<char>(random() % static_cast<unsigned>(letters));
    }
  }
  bytes.resize(size);
  return bytes;
}

TEST(LzfPack, LiblzfUnpacksWhatWasPacked) {
  for (const std::size_t size : {0, 1, 2, 3, 4, 31, 32, 33, 64, 65, 263, 264, 265, 266, 267, 530}) {
    for (const int letters : {1, 2, 256}) {
      const std::string bytes = text(size, letters, 7);
      ASSERT_EQ(unpacked(packed(bytes), size), bytes) << size << " of " << letters;
    }
  }
  for (unsigned seed = 0; seed < 40; ++seed) {
    const std::string bytes = text(1000 + 5000 * seed, 1 + static_cast<int>(seed * 6), seed);
    ASSERT_EQ(unpacked(packed(bytes), bytes.size()), bytes) << seed;
  }
}

TEST(LzfPack, PiecesUnpackInARow) {
  std::string all;
  std::string pieces;
  for (unsigned i = 0; i < 20; ++i) {
    const std::string piece = text(i * 977, 3, 3);  // alike, which must not lead across pieces
    all += piece;
    append_lzf(piece, pieces);
  }
  EXPECT_EQ(unpacked(pieces, all.size()), all);
}

TEST(LzfPack, MakesWhatRepeatsSmallAndNothingMuchLarger) {
  EXPECT_LT(packed(std::string(264'000, 'a')).size(), 3'100U) << "3 bytes for 264";
  std::mt19937 random(1);
  std::string noise(100'000, '\0');
  for (char& c : noise) c = static_cast<char>(random());
  EXPECT_LE(packed(noise).size(), noise.size() * 33 / 32 + 1);
}

}  // namespace
}  // namespace kissmap
