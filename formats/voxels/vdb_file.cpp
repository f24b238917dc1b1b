// SPDX-License-Identifier: MIT
#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "formats/files/aside_file.hpp"
#include "formats/files/xxh3.hpp"
#include "formats/voxels/voxel_files.hpp"
#include "kissmap/error.hpp"
#include "kissmap/version.hpp"

namespace kissmap {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

static_assert(Leaf::DIM == occupancy_block_side);

/// OpenVDB's own file class writes to a path and does not say when the disk is full.
class MemoryArchive : public openvdb::io::Archive {
 public:
  std::string write_grid(const openvdb::FloatGrid::ConstPtr& grid) const {
    std::ostringstream bytes;
    bytes.exceptions(std::ios::badbit | std::ios::failbit);
    write(bytes, openvdb::GridCPtrVec{grid}, true);
    std::string file = std::move(bytes).str();
    name_by_content(file);
    return file;
  }

 private:
  /// OpenVDB marks each file by 36 random characters, which would differ from run to run.
  void name_by_content(std::string& file) const {
    const std::string tag = getUniqueTag();
    const std::size_t place = file.find(tag);
    if (tag.empty() || place > 64) return;
    for (std::size_t i = 0; i < tag.size(); ++i) {
      if (tag[i] != '-') file[place + i] = '0';
    }
    const std::string digits = xxh3_hex(file);
    for (std::size_t i = 0, used = 0; i < tag.size() && used < digits.size(); ++i) {
      if (tag[i] != '-') file[place + i] = digits[used++];
    }
  }
};

openvdb::Coord coord(const Voxel& voxel) {
  return {voxel.x, voxel.y, voxel.z};
}

/// Whether all voxels are known alike.
bool is_uniform(const OccupancyBlock& block) {
  return block.values[0] != unknown_log_odds &&
         std::ranges::all_of(block.values, [&](LogOdds v) { return v == block.values[0]; });
}

void add_block(const OccupancyBlock& block, double unit, openvdb::FloatTree& tree) {
  if (is_uniform(block)) {
    constexpr openvdb::Index level_of_blocks = 1;
    const auto value = static_cast<float>(unit * block.values[0]);
    return tree.addTile(level_of_blocks, coord(block.first), value, true);
  }
  Leaf* leaf = tree.touchLeaf(coord(block.first));
  for (std::uint32_t i = 0; i < 512; ++i) {
    const LogOdds value = block.values[i];
    if (value == unknown_log_odds) continue;
    const std::uint32_t offset = (i % 8) << 6U | (i / 8 % 8) << 3U | i / 64;  // z runs fastest
    leaf->setValueOn(offset, static_cast<float>(unit * value));
  }
}

openvdb::math::Transform::Ptr transform_of(const OccupancyGeometry& geometry) {
  const Eigen::Vector3d& size = geometry.voxel_size;
  const Eigen::Vector3d first_center = voxel_center(geometry, Voxel{});
  auto transform = openvdb::math::Transform::createLinearTransform(size.x());
  if ((size.array() != size.x()).any()) {
    transform->preScale({1.0, size.y() / size.x(), size.z() / size.x()});
  }
  transform->postTranslate({first_center.x(), first_center.y(), first_center.z()});
  return transform;
}

void describe(const VoxelWriterOptions& options,
              const LogOddsSteps& steps,
              openvdb::FloatGrid& grid) {
  const auto number = [&grid](const char* name, double value) {
    grid.insertMeta(name, openvdb::DoubleMetadata(value));
  };
  grid.setName("occupancy");
  grid.setCreator(std::string("kissmap ") + version());
  grid.insertMeta("frame", openvdb::StringMetadata(options.frame));
  grid.insertMeta("values", openvdb::StringMetadata("log-odds of being occupied"));
  number("resolution", options.geometry.voxel_size.x());
  number("occupied_above", steps.unit * steps.occupied);
  number("hit", steps.unit * steps.hit);
  number("miss", -steps.unit * steps.miss);
  number("lowest", steps.unit * steps.min);
  number("highest", steps.unit * steps.max);
}

class VdbWriter : public VoxelWriter {
 public:
  VdbWriter(const std::filesystem::path& path, const VoxelWriterOptions& options)
      : file_(path), steps_(LogOddsSteps::from(options.log_odds)) {
    openvdb::initialize();
    grid_ = openvdb::FloatGrid::create(0.0F);
    grid_->setTransform(transform_of(options.geometry));
    describe(options, steps_, *grid_);
  }

  void add(const OccupancyMap& part) override {
    part.for_each_block(
        [this](const OccupancyBlock& block) { add_block(block, steps_.unit, grid_->tree()); });
  }

  void finish() override {
    grid_->tree().prune();
    file_.write(MemoryArchive().write_grid(grid_));
    file_.publish({});
  }

 private:
  AsideFile file_;
  LogOddsSteps steps_;
  openvdb::FloatGrid::Ptr grid_;
};

}  // namespace

std::unique_ptr<VoxelWriter> open_vdb_writer(const std::filesystem::path& path,
                                             const VoxelWriterOptions& options) {
  return std::make_unique<VdbWriter>(path, options);
}

}  // namespace kissmap
