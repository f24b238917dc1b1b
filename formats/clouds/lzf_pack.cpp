// SPDX-License-Identifier: MIT
#include "formats/clouds/lzf_pack.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace kissmap {
namespace {

// The format's own: a control byte below 32 is followed by so many and one more literals; otherwise
// its upper three bits are a length and its lower five the upper bits of a distance.
constexpr std::size_t most_literals = 32;
constexpr std::size_t shortest_match = 3;
constexpr std::size_t longest_match = 264;
constexpr std::size_t farthest_match = 8192;
constexpr unsigned table_bits = 14;

std::uint32_t hash_of_three(const char* bytes) {
  const std::uint32_t three =
      static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[0])) |
      static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[1])) << 8U |
      static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[2])) << 16U;
  return (three * 2654435761U) >> (32U - table_bits);
}

void append_literals(std::string_view literals, std::string& packed) {
  while (!literals.empty()) {
    const std::string_view run = literals.substr(0, most_literals);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
    literals.remove_prefix(run.size());
  }
}

void append_match(std::size_t length, std::size_t distance, std::string& packed) {
  const std::size_t code = length - 2;
  const std::size_t back = distance - 1;
  packed += static_cast<char>((std::min<std::size_t>(code, 7) << 5U) | (back >> 8U));
  if (code >= 7) packed += static_cast<char>(code - 7);
  packed += static_cast<char>(back & 0xFFU);
}

/// How many bytes at `here` are the same as at `there`, which is before it.
std::size_t match_length(std::string_view bytes, std::size_t there, std::size_t here) {
  const std::size_t most = std::min(longest_match, bytes.size() - here);
  std::size_t length = 0;
  while (length < most && bytes[there + length] == bytes[here + length]) ++length;
  return length;
}

}  // namespace

void append_lzf(std::string_view bytes, std::string& packed) {
  std::vector<std::uint32_t> last_place(std::size_t{1} << table_bits);  // plus one; 0: never
  std::size_t literals_begin = 0;
  std::size_t here = 0;
  while (here + shortest_match <= bytes.size()) {
    std::uint32_t& entry = last_place[hash_of_three(bytes.data() + here)];
    const std::size_t there = entry;
    entry = static_cast<std::uint32_t>(here + 1);
    const bool near = there != 0 && here - (there - 1) <= farthest_match;
    const std::size_t length = near ? match_length(bytes, there - 1, here) : 0;
    if (length < shortest_match) {
      ++here;
      continue;
    }
    append_literals(bytes.substr(literals_begin, here - literals_begin), packed);
    append_match(length, here - (there - 1), packed);
    here += length;
    literals_begin = here;
  }
  append_literals(bytes.substr(literals_begin), packed);
}

}  // namespace kissmap
