// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace kissmap {

/// Picks at most `most` of `count` things in a row, evenly: one of each group of neighbours. Which
/// one varies from group to group (Weyl's sequence), as points of a scan come from lasers that take
/// turns: every fourth of 64 lasers would be the same 16.
class Thinning {
 public:
  Thinning(std::size_t count, std::size_t most)
      : count_(count), group_(1 + (count == 0 ? 0 : (count - 1) / most)) {}

  /// Calls visit(index), ascending.
  template <typename Visitor>
  void for_each(Visitor visit) const {
    std::uint32_t share = 0;  // of a group, in units of 2^-32
    for (std::size_t first = 0; first < count_; first += group_) {
      const std::size_t index = first + ((std::uint64_t{share} * group_) >> 32U);
      if (index < count_) visit(index);
      share += golden;
    }
  }

 private:
  static constexpr std::uint32_t golden = 0x9E3779B9;  // of 2^32, the golden section

  std::size_t count_;
  std::size_t group_;
};

}  // namespace kissmap
