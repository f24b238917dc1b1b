// SPDX-License-Identifier: MIT
#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <locale>
#include <sstream>

#include "formats/files/aside_file.hpp"
#include "formats/voxels/voxel_files.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using octomap::OcTreeKey;
using octomap::OcTreeNode;

constexpr int tree_depth = 16;
constexpr int block_depth = 13;  // of the node that covers 8 x 8 x 8 voxels
constexpr std::int32_t key_of_zero = 1 << 15;

static_assert(occupancy_block_side == 1 << (tree_depth - block_depth));

/// Beliefs as an OctoMap tree, pruned as it grows: a block that is alike all over is one node.
/// OctoMap's own prune() stops at the first depth where there is nothing to do, which is the last
/// one here.
class OctreeBuilder {
 public:
  /// Of a binary tree only the sign of a belief is kept.
  OctreeBuilder(double resolution, const LogOddsSteps& steps, bool binary)
      : steps_(steps), binary_(binary), unit_(binary ? 1.0 : steps_.unit), tree_(resolution) {}

  void add(const OccupancyBlock& block) {
    for (std::size_t i = 0; i < beliefs_.size(); ++i) beliefs_[i] = kept(block.values[i]);
    const OcTreeKey key(key_of(block.first.x), key_of(block.first.y), key_of(block.first.z));
    fill(node_of_block(key), 0, occupancy_block_side);
  }

  /// Joins what is alike across blocks.
  const octomap::OcTree& finish() {
    if (tree_.getRoot() != nullptr) join(*tree_.getRoot(), 0);
    tree_.updateInnerOccupancy();
    return tree_;
  }

 private:
  static octomap::key_type key_of(std::int32_t index) {
    return static_cast<octomap::key_type>(index + key_of_zero);
  }

  LogOdds kept(LogOdds value) const {
    if (!binary_ || value == unknown_log_odds) return value;
    return steps_.is_occupied(value) ? LogOdds{1} : LogOdds{-1};
  }

  OcTreeNode& child_of(OcTreeNode& node, unsigned int child) {
    if (tree_.nodeChildExists(&node, child)) return *tree_.getNodeChild(&node, child);
    return *tree_.createNodeChild(&node, child);
  }

  OcTreeNode& node_of_block(const OcTreeKey& key) {
    // A tree gets its root with its first voxel, whose belief fill() then finds or overwrites.
    if (tree_.getRoot() == nullptr) tree_.setNodeValue(first_known(key), 0.0F, true);
    OcTreeNode* node = tree_.getRoot();
    for (int depth = 0; depth < block_depth; ++depth) {
      node = &child_of(*node, octomap::computeChildIdx(key, tree_depth - 1 - depth));
    }
    return *node;
  }

  OcTreeKey first_known(const OcTreeKey& key) const {
    const auto known =
        std::ranges::find_if(beliefs_, [](LogOdds value) { return value != unknown_log_odds; });
    const auto i = static_cast<unsigned>(known - beliefs_.begin());
    return {static_cast<octomap::key_type>(key[0] + i % 8),
            static_cast<octomap::key_type>(key[1] + i / 8 % 8),
            static_cast<octomap::key_type>(key[2] + i / 64)};
  }

  /// Whether all beliefs of a cube of the block are those of its first.
  bool alike(std::size_t first, std::size_t side) const {
    for (std::size_t z = 0; z < side; ++z) {
      for (std::size_t y = 0; y < side; ++y) {
        const auto* row = beliefs_.data() + first + 64 * z + 8 * y;
        if (std::any_of(row, row + side, [&](LogOdds v) { return v != beliefs_[first]; })) {
          return false;
        }
      }
    }
    return true;
  }

  /// Gives a node the cube of the block that begins at `first`, in which something is known.
  void fill(OcTreeNode& node, std::size_t first, std::size_t side) {
    if (!tree_.nodeHasChildren(&node) && alike(first, side)) {
      node.setLogOdds(static_cast<float>(unit_ * beliefs_[first]));
      return;
    }
    const std::size_t half = side / 2;
    for (unsigned int child = 0; child < 8; ++child) {
      const std::size_t begin =
          first + half * ((child & 1U) + 8 * (child >> 1U & 1U) + 64 * (child >> 2U));
      if (beliefs_[begin] == unknown_log_odds && alike(begin, half)) continue;
      fill(child_of(node, child), begin, half);
    }
    tree_.pruneNode(&node);
  }

  void join(OcTreeNode& node, int depth) {
    if (depth == block_depth) return;
    for (unsigned int child = 0; child < 8; ++child) {
      if (tree_.nodeChildExists(&node, child)) join(*tree_.getNodeChild(&node, child), depth + 1);
    }
    tree_.pruneNode(&node);
  }

  LogOddsSteps steps_;
  bool binary_;
  double unit_;
  octomap::OcTree tree_;
  std::array<LogOdds, 512> beliefs_{};
};

class OctreeWriter : public VoxelWriter {
 public:
  OctreeWriter(const std::filesystem::path& path, const VoxelWriterOptions& options, bool binary)
      : path_(path),
        binary_(binary),
        resolution_(options.geometry.voxel_size.x()),
        file_(path),
        builder_(resolution_, LogOddsSteps::from(options.log_odds), binary) {}

  void add(const OccupancyMap& part) override {
    part.for_each_block([this](const OccupancyBlock& block) {
      require_reach(block);
      builder_.add(block);
    });
  }

  void finish() override {
    const octomap::OcTree& tree = builder_.finish();
    std::ostringstream bytes;
    bytes.imbue(std::locale::classic());
    // OctoMap's writeBinary() writes the same and chats on stderr.
    bytes << (binary_ ? "# Octomap OcTree binary file\n" : "# Octomap OcTree file\n") << "id "
          << tree.getTreeType() << "\nsize " << tree.size() << "\nres " << resolution_
          << "\ndata\n";
    if (!(binary_ ? tree.writeBinaryData(bytes) : tree.writeData(bytes))) {
      throw output_error(path_, "OctoMap could not write the tree; free some memory");
    }
    file_.write(bytes.view());
    file_.publish({});
  }

 private:
  void require_reach(const OccupancyBlock& block) const {
    const std::int32_t last = key_of_zero - occupancy_block_side;
    const auto outside = [&](std::int32_t index) { return index < -key_of_zero || index > last; };
    if (!outside(block.first.x) && !outside(block.first.y) && !outside(block.first.z)) return;
    std::ostringstream message;
    message << path_.string() << ": OctoMap reaches " << key_of_zero * resolution_
            << " m from the origin with voxels of " << resolution_
            << " m, the map goes farther; take a coarser --resolution, or write .vdb";
    throw usage_error(message.str());
  }

  std::filesystem::path path_;
  bool binary_;
  double resolution_;
  AsideFile file_;
  OctreeBuilder builder_;
};

void require_cubes(const OccupancyGeometry& geometry, const std::filesystem::path& path) {
  const bool cubes = (geometry.voxel_size.array() == geometry.voxel_size.x()).all();
  if (cubes && geometry.origin.isZero(0.0)) return;
  throw usage_error(path.string() +
                    ": OctoMap has cubes that begin at 0 only; write .vdb, which has others");
}

}  // namespace

std::unique_ptr<VoxelWriter> open_octree_writer(const std::filesystem::path& path,
                                                const VoxelWriterOptions& options,
                                                bool binary) {
  require_cubes(options.geometry, path);
  return std::make_unique<OctreeWriter>(path, options, binary);
}

}  // namespace kissmap
