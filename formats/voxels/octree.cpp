// SPDX-License-Identifier: MIT
#include "formats/voxels/octree.hpp"

#include <algorithm>
#include <array>

#include "formats/clouds/point_columns.hpp"

namespace kissmap {
namespace {

using Kind = OctreeNode::Kind;

constexpr std::array<OctreeNode, 8> no_children{};

class MaximumLikelihoodCode : public OctreeCode {
 public:
  explicit MaximumLikelihoodCode(const LogOddsSteps& steps) : steps_(steps) {}

  LogOdds value_of(LogOdds value) const override {
    return steps_.is_occupied(value) ? steps_.max : steps_.min;
  }

  void append(const OctreeNode& node, OctreeChildren children, std::string& bytes) const override {
    if (node.kind != Kind::inner) return;  // its parent has told all
    unsigned codes = 0;
    for (unsigned c = 0; c < 8; ++c) codes |= code_of(children[c]) << (2 * c);
    append_value(static_cast<std::uint16_t>(codes), bytes);
  }

 private:
  unsigned code_of(const OctreeNode& child) const {
    if (child.kind == Kind::absent) return 0;
    if (child.kind == Kind::inner) return 3;
    return steps_.is_occupied(child.value) ? 2 : 1;
  }

  LogOddsSteps steps_;
};

class LogOddsCode : public OctreeCode {
 public:
  explicit LogOddsCode(const LogOddsSteps& steps) : steps_(steps) {}

  LogOdds value_of(LogOdds value) const override { return value; }

  void append(const OctreeNode& node, OctreeChildren children, std::string& bytes) const override {
    const double value = node.value == 0 ? -1e-6 : steps_.unit * node.value;
    append_value(static_cast<float>(value), bytes);
    unsigned there = 0;
    for (unsigned c = 0; c < 8; ++c) {
      there |= (children[c].kind == Kind::absent ? 0U : 1U) << c;
    }
    append_value(static_cast<std::uint8_t>(there), bytes);
  }

 private:
  LogOddsSteps steps_;
};

/// Every third bit.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1F00000000FFFFULL;
  bits = (bits | bits << 16) & 0x1F0000FF0000FFULL;
  bits = (bits | bits << 8) & 0x100F00F00F00F00FULL;
  bits = (bits | bits << 4) & 0x10C30C30C30C30C3ULL;
  return (bits | bits << 2) & 0x1249249249249249ULL;
}

/// For each voxel of a block in the order of a tree: where its value is.
std::array<std::uint16_t, 512> voxels_in_tree_order() {
  std::array<std::uint16_t, 512> places{};
  for (std::size_t i = 0; i < 512; ++i) {
    places[octree_order(i % 8, i / 8 % 8, i / 64)] = static_cast<std::uint16_t>(i);
  }
  return places;
}

/// The tree over a block, level by level: 512 voxels, 64, 8, 1.
class BlockTree {
 public:
  BlockTree(const OccupancyBlock& block, const OctreeCode& code) : code_(code) {
    static const std::array<std::uint16_t, 512> places = voxels_in_tree_order();
    for (std::size_t i = 0; i < 512; ++i) {
      const LogOdds value = block.values[places[i]];
      if (value != unknown_log_odds) at(0, i) = {Kind::leaf, code.value_of(value)};
    }
    for (std::size_t level = 1; level < 4; ++level) {
      for (std::size_t i = 0; i < std::size_t{512} >> 3 * level; ++i) {
        at(level, i) = parent_of(children(level, i));
      }
    }
  }

  const OctreeNode& root() const { return nodes_.back(); }

  /// Number of nodes.
  std::uint32_t append(std::size_t level, std::size_t i, std::string& bytes) const {
    const OctreeNode& node = nodes_[begin[level] + i];
    if (node.kind == Kind::absent) return 0;
    if (level == 0 || node.kind == Kind::leaf) {
      code_.append(node, no_children, bytes);
      return 1;
    }
    code_.append(node, children(level, i), bytes);
    std::uint32_t nodes = 1;
    for (std::size_t c = 0; c < 8; ++c) nodes += append(level - 1, 8 * i + c, bytes);
    return nodes;
  }

 private:
  static constexpr std::array<std::size_t, 4> begin = {0, 512, 576, 584};

  OctreeChildren children(std::size_t level, std::size_t i) const {
    return OctreeChildren(nodes_.data() + begin[level - 1] + 8 * i, 8);
  }
  OctreeNode& at(std::size_t level, std::size_t i) { return nodes_[begin[level] + i]; }

  const OctreeCode& code_;
  std::array<OctreeNode, 512 + 64 + 8 + 1> nodes_{};
};

}  // namespace

OctreeNode parent_of(OctreeChildren children) {
  OctreeNode parent;
  bool alike = true;
  for (const OctreeNode& child : children) {
    if (child.kind != Kind::absent) {
      parent.kind = Kind::inner;
      parent.value = std::max(parent.value, child.value);
    }
    alike = alike && child.kind == Kind::leaf && child.value == children[0].value;
  }
  if (alike) parent.kind = Kind::leaf;
  return parent;
}

std::unique_ptr<OctreeCode> maximum_likelihood_code(const LogOddsSteps& steps) {
  return std::make_unique<MaximumLikelihoodCode>(steps);
}

std::unique_ptr<OctreeCode> log_odds_code(const LogOddsSteps& steps) {
  return std::make_unique<LogOddsCode>(steps);
}

BlockRoot append_block(const OccupancyBlock& block, const OctreeCode& code, std::string& bytes) {
  const BlockTree tree(block, code);
  const std::uint32_t nodes = tree.append(3, 0, bytes);
  return {tree.root(), nodes};
}

std::uint64_t octree_order(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

}  // namespace kissmap
