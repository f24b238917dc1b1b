// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "kissmap/occupancy/occupancy_map.hpp"

namespace kissmap {

/// A node of an OctoMap tree (Hornung et al., Autonomous Robots 2013). Child c lies in the upper
/// half along x, y, z if bit 0, 1, 2 of c is set. A leaf above the finest level stands for all
/// voxels below it.
struct OctreeNode {
  enum class Kind : std::uint8_t { absent, leaf, inner };
  Kind kind = Kind::absent;
  LogOdds value = unknown_log_odds;  ///< of a leaf; the highest below an inner node
};
using OctreeChildren = std::span<const OctreeNode, 8>;

/// The node above these, pruned: a leaf where all eight are leaves and alike.
OctreeNode parent_of(OctreeChildren children);

/// How nodes become bytes: each that exists once, parents before children.
class OctreeCode {
 public:
  virtual ~OctreeCode() = default;
  /// The value by which voxels are told apart.
  virtual LogOdds value_of(LogOdds value) const = 0;
  /// `children` are all absent below a leaf.
  virtual void append(const OctreeNode& node,
                      OctreeChildren children,
                      std::string& bytes) const = 0;
};
/// .bt: 16 bits an inner node, two a child: 0 absent, 1 free, 2 occupied, 3 inner.
std::unique_ptr<OctreeCode> maximum_likelihood_code(const LogOddsSteps& steps);
/// .ot: 32 bits log-odds and 8 bits children that exist. A leaf of exactly even odds is written a
/// millionth lower: OctoMap takes it for occupied, where kissmap does not.
std::unique_ptr<OctreeCode> log_odds_code(const LogOddsSteps& steps);

/// The tree over 8^3 voxels: what its parent has to know. Its bytes are appended.
struct BlockRoot {
  OctreeNode node;
  std::uint32_t nodes = 0;  ///< of the tree
};
BlockRoot append_block(const OccupancyBlock& block, const OctreeCode& code, std::string& bytes);

/// Numbers of x, y and z below 2^21 as one: the order in which a tree is walked.
std::uint64_t octree_order(std::uint64_t x, std::uint64_t y, std::uint64_t z);

}  // namespace kissmap
