// SPDX-License-Identifier: MIT
// OctoMap's files as AbstractOcTree and OccupancyOcTreeBase of its 1.9 read them: a header as text,
// then the nodes of a tree of 16 levels. OctoMap's own tree would take 50 bytes of memory for every
// voxel that cannot be pruned, so the nodes are written from blocks instead, which are its subtrees
// of three levels.
#include <algorithm>
#include <array>
#include <sstream>
#include <vector>

#include "formats/clouds/point_columns.hpp"
#include "formats/files/aside_file.hpp"
#include "formats/voxels/octree.hpp"
#include "formats/voxels/voxel_files.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

using Kind = OctreeNode::Kind;

constexpr std::size_t levels_above_blocks = 13;
constexpr std::int32_t key_of_zero = 1 << 15;
constexpr std::array<OctreeNode, 8> no_children{};

static_assert(occupancy_block_side == 1 << (16 - levels_above_blocks));

/// The bytes of a block among those of all.
struct StoredBlock {
  std::uint64_t order = 0;  ///< octree_order()
  std::size_t begin = 0;
  std::uint16_t size = 0;
  BlockRoot root;
};

/// A node above blocks, or the root of one.
struct UpperNode {
  std::uint64_t order = 0;  ///< octree_order() on its own level
  OctreeNode node;
  std::size_t first_child = 0;  ///< on the level below; of a block: among those stored
};
using Level = std::vector<UpperNode>;

Level level_above(const Level& below) {
  Level level;
  for (std::size_t begin = 0; begin < below.size();) {
    const std::uint64_t order = below[begin].order >> 3;
    std::array<OctreeNode, 8> children{};
    std::size_t end = begin;
    for (; end < below.size() && below[end].order >> 3 == order; ++end) {
      children[below[end].order & 7U] = below[end].node;
    }
    level.push_back({order, parent_of(children), begin});
    begin = end;
  }
  return level;
}

class OctreeWriter : public VoxelWriter {
 public:
  OctreeWriter(const std::filesystem::path& path, const VoxelWriterOptions& options, bool binary)
      : options_(options), binary_(binary), file_(path) {
    const LogOddsSteps steps = LogOddsSteps::from(options.log_odds);
    code_ = binary ? maximum_likelihood_code(steps) : log_odds_code(steps);
    file_.write(header());
  }

  void add(const OccupancyMap& part) override {
    part.for_each_block([this](const OccupancyBlock& block) {
      StoredBlock stored;
      stored.order = octree_order(
          block_number(block.first.x), block_number(block.first.y), block_number(block.first.z));
      stored.begin = bytes_.size();
      stored.root = append_block(block, *code_, bytes_);
      stored.size = static_cast<std::uint16_t>(bytes_.size() - stored.begin);
      blocks_.push_back(stored);
    });
  }

  void finish() override {
    std::ranges::sort(blocks_, {}, &StoredBlock::order);
    if (!blocks_.empty()) {
      make_levels();
      write_node(levels_above_blocks, 0);
    }
    file_.publish(header());
  }

 private:
  /// Counted from OctoMap's lower end.
  std::uint64_t block_number(std::int32_t first) const {
    if (first < -key_of_zero || first >= key_of_zero) throw beyond_reach();
    return static_cast<std::uint64_t>(first + key_of_zero) / occupancy_block_side;
  }

  Error beyond_reach() const {
    const double size = options_.geometry.voxel_size.x();
    std::ostringstream message;
    message << file_.path().string() << ": OctoMap reaches " << key_of_zero * size
            << " m from the origin with voxels of " << size
            << " m, the map goes farther; take a coarser --resolution, or write .vdb";
    return usage_error(message.str());
  }

  /// As long for any number of nodes, so that the final one fits over the first.
  std::string header() const {
    constexpr std::size_t longest_number = 20;
    const std::string number = std::to_string(nodes_);
    return std::string(binary_ ? "# Octomap OcTree binary file" : "# Octomap OcTree file") +
           "\n# made by kissmap; frame " + options_.frame + ", metres; occupied above " +
           shortest_decimal(options_.log_odds.occupied_probability) + "\nid OcTree\nsize " +
           number + std::string(longest_number - number.size(), ' ') + "\nres " +
           shortest_decimal(options_.geometry.voxel_size.x()) + "\ndata\n";
  }

  void make_levels() {
    levels_.resize(1);
    levels_[0].reserve(blocks_.size());
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      levels_[0].push_back({blocks_[i].order, blocks_[i].root.node, i});
    }
    for (std::size_t i = 0; i < levels_above_blocks; ++i) {
      levels_.push_back(level_above(levels_.back()));
    }
    // OctoMap's own pruning leaves the root, and its readers expect one with children.
    levels_.back()[0].node.kind = Kind::inner;
  }

  void write_node(std::size_t level, std::size_t i) {
    const UpperNode& node = levels_[level][i];
    if (level == 0) {
      const StoredBlock& block = blocks_[node.first_child];
      file_.write(std::string_view(bytes_).substr(block.begin, block.size));
      nodes_ += block.root.nodes;
      return;
    }
    ++nodes_;
    std::string bytes;
    if (node.node.kind == Kind::leaf) {
      code_->append(node.node, no_children, bytes);
      return file_.write(bytes);
    }
    const Level& below = levels_[level - 1];
    const auto is_child = [&](std::size_t c) {
      return c < below.size() && below[c].order >> 3 == node.order;
    };
    std::array<OctreeNode, 8> children{};
    for (std::size_t c = node.first_child; is_child(c); ++c) {
      children[below[c].order & 7U] = below[c].node;
    }
    code_->append(node.node, children, bytes);
    file_.write(bytes);
    for (std::size_t c = node.first_child; is_child(c); ++c) write_node(level - 1, c);
  }

  VoxelWriterOptions options_;
  bool binary_;
  std::unique_ptr<OctreeCode> code_;
  AsideFile file_;
  std::string bytes_;  ///< of the trees of all blocks, in the order they came
  std::vector<StoredBlock> blocks_;
  std::vector<Level> levels_;  ///< from the blocks to the root
  std::uint64_t nodes_ = 0;
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
