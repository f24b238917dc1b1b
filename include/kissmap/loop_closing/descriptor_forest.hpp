// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kissmap/loop_closing/place_features.hpp"

namespace kissmap {

/// Finds descriptors near a given one among millions, most of them but not all.
///
/// Several binary trees, each splitting its descriptors by single bits; a tree asks of each leaf
/// that overflows the bit, out of a random choice of its own, that halves it best. A search walks
/// one path in every tree and compares what stands in the leaves: time grows with the logarithm of
/// the number of descriptors. A descriptor k bits away from the query shares its leaf in one tree
/// with a probability of about (1 - k/256)^depth; eight trees make up for the depth.
/// Same answers on every run. Reading is thread safe, adding is not.
class DescriptorForest {
 public:
  /// Where a descriptor came from.
  struct Entry {
    std::uint32_t place = 0;    ///< local map
    std::uint32_t feature = 0;  ///< of its features
  };
  struct Match {
    Entry entry;
    int distance = 0;  ///< bits
  };

  DescriptorForest();

  /// Adds all descriptors of a place; `place` must not fall from call to call.
  void add(std::uint32_t place, const std::vector<Descriptor>& descriptors);

  /// For each place below `end_of_places` that holds a descriptor within `max_distance` bits among
  /// those found: the nearest one, in ascending order of place.
  std::vector<Match> search(const Descriptor& query,
                            int max_distance,
                            std::uint32_t end_of_places) const;

  std::size_t size() const { return entries_.size(); }
  std::size_t memory_bytes() const;

 private:
  static constexpr std::size_t tree_count = 8;
  static constexpr std::size_t leaf_size = 32;

  struct Node {
    std::uint32_t first_child = 0;  ///< 0: a leaf; the second child stands behind the first
    std::uint32_t leaf = 0;         ///< number of its leaf
    std::uint16_t bit = 0;          ///< that decides between the children
  };
  struct Leaf {
    std::array<std::uint32_t, leaf_size> items{};
    std::uint32_t count = 0;
  };
  struct Tree {
    std::vector<Node> nodes;
    std::vector<Leaf> leaves;
    std::uint64_t seed = 0;
  };

  static std::uint32_t find_leaf_node(const Tree& tree, const Descriptor& descriptor);
  void insert(Tree& tree, std::uint32_t item);
  bool split(Tree& tree, std::uint32_t node) const;

  std::vector<Tree> trees_;
  std::vector<Descriptor> descriptors_;
  std::vector<Entry> entries_;
};

}  // namespace kissmap
