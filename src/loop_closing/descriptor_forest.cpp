// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/descriptor_forest.hpp"

#include <algorithm>
#include <cstdlib>

#include "random_bits.hpp"

namespace kissmap {
namespace {

constexpr int bits_tried = 48;  // of 256, at each split

bool bit_of(const Descriptor& descriptor, unsigned bit) {
  return ((descriptor[bit / 64U] >> (bit % 64U)) & 1U) != 0;
}

}  // namespace

DescriptorForest::DescriptorForest() : trees_(tree_count) {
  for (std::size_t i = 0; i < trees_.size(); ++i) {
    trees_[i].seed = i;
    trees_[i].nodes.emplace_back();
    trees_[i].leaves.emplace_back();
  }
}

void DescriptorForest::add(std::uint32_t place, const std::vector<Descriptor>& descriptors) {
  for (std::uint32_t i = 0; i < descriptors.size(); ++i) {
    const auto item = static_cast<std::uint32_t>(entries_.size());
    descriptors_.push_back(descriptors[i]);
    entries_.push_back({place, i});
    for (Tree& tree : trees_) insert(tree, item);
  }
}

std::uint32_t DescriptorForest::find_leaf_node(const Tree& tree, const Descriptor& descriptor) {
  std::uint32_t node = 0;
  while (tree.nodes[node].first_child != 0) {
    node = tree.nodes[node].first_child + (bit_of(descriptor, tree.nodes[node].bit) ? 1U : 0U);
  }
  return node;
}

void DescriptorForest::insert(Tree& tree, std::uint32_t item) {
  std::uint32_t node = find_leaf_node(tree, descriptors_[item]);
  while (tree.leaves[tree.nodes[node].leaf].count == leaf_size) {
    // A leaf of equal descriptors cannot be split. One more of them tells no place from another.
    if (!split(tree, node)) return;
    node =
        tree.nodes[node].first_child + (bit_of(descriptors_[item], tree.nodes[node].bit) ? 1U : 0U);
  }
  Leaf& leaf = tree.leaves[tree.nodes[node].leaf];
  leaf.items[leaf.count++] = item;
}

bool DescriptorForest::split(Tree& tree, std::uint32_t node) const {
  const Leaf items = tree.leaves[tree.nodes[node].leaf];
  RandomBits random(tree.seed * 0x9E3779B97F4A7C15ULL + node);
  int best_imbalance = static_cast<int>(leaf_size);
  unsigned best_bit = 0;
  for (int i = 0; i < bits_tried; ++i) {
    const auto bit = static_cast<unsigned>(random.next() % 256U);
    int ones = 0;
    for (const std::uint32_t item : items.items) ones += bit_of(descriptors_[item], bit) ? 1 : 0;
    const int imbalance = std::abs(2 * ones - static_cast<int>(leaf_size));
    if (imbalance < best_imbalance) {
      best_imbalance = imbalance;
      best_bit = bit;
    }
  }
  if (best_imbalance == static_cast<int>(leaf_size)) return false;
  // The first child takes over the leaf, the second a new one.
  const auto first_child = static_cast<std::uint32_t>(tree.nodes.size());
  const auto new_leaf = static_cast<std::uint32_t>(tree.leaves.size());
  tree.nodes.push_back({0, tree.nodes[node].leaf, 0});
  tree.nodes.push_back({0, new_leaf, 0});
  tree.leaves.emplace_back();
  tree.nodes[node].first_child = first_child;
  tree.nodes[node].bit = static_cast<std::uint16_t>(best_bit);
  Leaf& zeros = tree.leaves[tree.nodes[node].leaf];
  Leaf& ones = tree.leaves[new_leaf];
  zeros.count = 0;
  for (const std::uint32_t item : items.items) {
    Leaf& leaf = bit_of(descriptors_[item], best_bit) ? ones : zeros;
    leaf.items[leaf.count++] = item;
  }
  return true;
}

std::vector<DescriptorForest::Match> DescriptorForest::search(const Descriptor& query,
                                                              int max_distance,
                                                              std::uint32_t end_of_places) const {
  std::vector<Match> matches;
  for (const Tree& tree : trees_) {
    const Leaf& leaf = tree.leaves[tree.nodes[find_leaf_node(tree, query)].leaf];
    for (std::uint32_t i = 0; i < leaf.count; ++i) {
      const Entry& entry = entries_[leaf.items[i]];
      if (entry.place >= end_of_places) continue;
      const int distance = hamming_distance(query, descriptors_[leaf.items[i]]);
      if (distance <= max_distance) matches.push_back({entry, distance});
    }
  }
  std::ranges::sort(matches, [](const Match& a, const Match& b) {
    if (a.entry.place != b.entry.place) return a.entry.place < b.entry.place;
    return a.distance != b.distance ? a.distance < b.distance : a.entry.feature < b.entry.feature;
  });
  const auto repeated =
      std::unique(matches.begin(), matches.end(), [](const Match& a, const Match& b) {
        return a.entry.place == b.entry.place;
      });
  matches.erase(repeated, matches.end());
  return matches;
}

std::size_t DescriptorForest::memory_bytes() const {
  std::size_t bytes =
      descriptors_.capacity() * sizeof(Descriptor) + entries_.capacity() * sizeof(Entry);
  for (const Tree& tree : trees_) {
    bytes += tree.nodes.capacity() * sizeof(Node) + tree.leaves.capacity() * sizeof(Leaf);
  }
  return bytes;
}

}  // namespace kissmap
