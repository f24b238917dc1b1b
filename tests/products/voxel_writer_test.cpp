// SPDX-License-Identifier: MIT
// Voxel files as the libraries they are for read them.
#include "formats/voxels/voxel_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <random>

#include "kissmap/error.hpp"
#include "products/cloud_table.hpp"
#include "support/file_size_limit.hpp"
#include "support/temp_dir.hpp"
#include "unit/occupancy/ray_oracle.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

using Beliefs = std::map<Voxel, LogOdds>;

const OccupancyGeometry tenth{{0.0, 0.0, 0.0}, {0.1, 0.1, 0.1}, std::nullopt};
const std::vector<std::string> endings = {".bt", ".ot", ".vdb", ".pcd", ".ply"};

/// A room seen often from its middle, which clamps its air, and once from places all over, so that
/// there are blocks that are alike, mixed and partly unknown, on both sides of 0.
OccupancyMap room(const OccupancyGeometry& geometry = tenth, double threshold = 0.5) {
  OccupancyOptions options;
  options.log_odds.occupied_probability = threshold;
  OccupancyMap map(geometry, options);
  ThreadPool pool(1);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> side(-1.0F, 1.0F);
  for (int i = 0; i < 16; ++i) {
    const float away = i < 10 ? 0.05F : 2.0F;
    const Eigen::Vector3f sensor(away * side(random), away * side(random), 0.5F * side(random));
    std::vector<TestRay> rays;
    for (int k = 0; k < 8000; ++k) {
      Eigen::Vector3f direction(side(random), side(random), side(random));
      direction *= 4.0F / direction.cwiseAbs().maxCoeff();  // onto a cube
      rays.push_back({sensor, sensor + direction, k % 20 > 0, 0.0F});
    }
    map.add(TestScan(rays).scan, pool);
  }
  return map;
}

/// What was cast into a map made with `threshold`, as one part.
void write_voxels(const OccupancyMap& map, const fs::path& path, double threshold = 0.5) {
  VoxelWriterOptions options;
  options.geometry = map.geometry();
  options.log_odds.occupied_probability = threshold;
  options.frame = "level";
  const auto writer = open_voxel_writer(path, options);
  writer->add(map);
  writer->finish();
}

Beliefs beliefs_of(const OccupancyMap& map) {
  Beliefs beliefs;
  map.for_each_voxel([&](const Voxel& voxel, LogOdds value) { beliefs.emplace(voxel, value); });
  return beliefs;
}

std::unique_ptr<octomap::OcTree> read_octree(const fs::path& path) {
  if (path.extension() == ".bt") return std::make_unique<octomap::OcTree>(path.string());
  return std::unique_ptr<octomap::OcTree>(
      dynamic_cast<octomap::OcTree*>(octomap::AbstractOcTree::read(path.string())));
}

/// Every voxel of a tree, those of larger leaves one by one.
template <class Value, class Of>
std::map<Voxel, Value> voxels_of(octomap::OcTree& tree, Of&& of) {
  tree.expand();
  std::map<Voxel, Value> voxels;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const octomap::OcTreeKey key = leaf.getKey();
    EXPECT_EQ(leaf.getDepth(), 16U);
    voxels[{key[0] - 32768, key[1] - 32768, key[2] - 32768}] = of(*leaf);
  }
  return voxels;
}

std::map<Voxel, bool> occupied_of(const OccupancyMap& map) {
  std::map<Voxel, bool> voxels;
  for (const auto& [voxel, value] : beliefs_of(map)) voxels[voxel] = map.steps().is_occupied(value);
  return voxels;
}

openvdb::FloatGrid::Ptr read_vdb(const fs::path& path) {
  openvdb::initialize();
  openvdb::io::File file(path.string());
  file.open();
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("occupancy"));
  file.close();
  return grid;
}

class VoxelWriter : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  fs::path written(const OccupancyMap& map, const std::string& name, double threshold = 0.5) const {
    write_voxels(map, path(name), threshold);
    return path(name);
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()));
  }

  TempDir folder_;
};

TEST_F(VoxelWriter, TheRoomHasAllKindsOfBlocks) {
  const OccupancyMap map = room();
  std::size_t alike = 0;
  std::size_t partly_unknown = 0;
  std::size_t of_both_signs = 0;
  map.for_each_block([&](const OccupancyBlock& block) {
    const auto [low, high] = std::ranges::minmax(block.values);
    alike += low == high ? 1 : 0;
    partly_unknown += low == unknown_log_odds ? 1 : 0;
    of_both_signs += low < 0 && high > 0 && low != unknown_log_odds ? 1 : 0;
  });
  EXPECT_GT(alike, 10U);
  EXPECT_GT(partly_unknown, 10U);
  EXPECT_GT(of_both_signs, 10U);
}

TEST_F(VoxelWriter, OctomapReadsEveryLogOddsBack) {
  const OccupancyMap map = room();
  const auto tree = read_octree(written(map, "room.ot"));
  ASSERT_NE(tree, nullptr);
  EXPECT_DOUBLE_EQ(tree->getResolution(), 0.1);
  std::map<Voxel, float> expected;
  for (const auto& [voxel, value] : beliefs_of(map)) {
    expected[voxel] = static_cast<float>(value == 0 ? -1e-6 : map.steps().unit * value);
  }
  const auto found =
      voxels_of<float>(*tree, [](const octomap::OcTreeNode& leaf) { return leaf.getLogOdds(); });
  EXPECT_TRUE(found == expected) << found.size() << " and " << expected.size();
}

/// The same map, made voxel by voxel by OctoMap itself.
octomap::OcTree tree_of(const OccupancyMap& map) {
  octomap::OcTree tree(map.geometry().voxel_size.x());
  map.for_each_voxel([&](const Voxel& voxel, LogOdds value) {
    const octomap::OcTreeKey key(static_cast<octomap::key_type>(voxel.x + 32768),
                                 static_cast<octomap::key_type>(voxel.y + 32768),
                                 static_cast<octomap::key_type>(voxel.z + 32768));
    const double odds = value == 0 ? -1e-6 : map.steps().unit * value;  // even is free for us
    tree.setNodeValue(key, static_cast<float>(odds), true);
  });
  tree.updateInnerOccupancy();
  for (std::size_t before = 0; before != tree.size();) {  // it stops early at times
    before = tree.size();
    tree.prune();
  }
  return tree;
}

std::string data_of(const std::string& file) {
  return file.substr(file.find("\ndata\n") + 6);
}

TEST_F(VoxelWriter, WritesTheBytesOctomapWrites) {
  const OccupancyMap map = room();
  octomap::OcTree tree = tree_of(map);
  ASSERT_TRUE(tree.write(path("theirs.ot").string()));
  const std::string full = data_of(file_text(written(map, "ours.ot")));
  EXPECT_TRUE(full == data_of(file_text(path("theirs.ot"))));
  EXPECT_GT(full.size(), 100'000U);
  ASSERT_TRUE(tree.writeBinary(path("theirs.bt").string()));
  EXPECT_TRUE(data_of(file_text(written(map, "ours.bt"))) == data_of(file_text(path("theirs.bt"))));
}

TEST_F(VoxelWriter, OctomapReadsOccupiedAndFreeBack) {
  for (const double threshold : {0.5, 0.2, 0.9}) {
    const OccupancyMap map = room(tenth, threshold);
    const auto tree = read_octree(written(map, "room.bt", threshold));
    const auto found = voxels_of<bool>(
        *tree, [&](const octomap::OcTreeNode& leaf) { return tree->isNodeOccupied(leaf); });
    EXPECT_TRUE(found == occupied_of(map)) << threshold;
  }
}

TEST_F(VoxelWriter, OctomapFindsVoxelsWhereTheMapHasThem) {
  const OccupancyMap map = room();
  const auto tree = read_octree(written(map, "room.bt"));
  for (const auto& [voxel, occupied] : occupied_of(map)) {
    const Eigen::Vector3d center = voxel_center(map.geometry(), voxel);
    const octomap::OcTreeNode* node = tree->search(center.x(), center.y(), center.z());
    ASSERT_NE(node, nullptr) << center.transpose();
    ASSERT_EQ(tree->isNodeOccupied(node), occupied) << center.transpose();
  }
}

TEST_F(VoxelWriter, TreesAreAsSmallAsOctomapMakesThem) {
  for (const char* name : {"room.bt", "room.ot"}) {
    const auto tree = read_octree(written(room(), name));
    const std::size_t nodes = tree->size();
    tree->expand();
    const std::size_t all = tree->size();
    for (std::size_t before = 0; before != tree->size();) {  // it stops early at times
      before = tree->size();
      tree->prune();
    }
    EXPECT_EQ(nodes, tree->size()) << name;
    EXPECT_LT(nodes, all - all / 5) << name;  // log-odds that differ cannot be joined
  }
}

TEST_F(VoxelWriter, InnerNodesAreAsLikelyAsTheLikeliestBelow) {
  const auto tree = read_octree(written(room(), "room.ot"));
  float most = -100.0F;
  for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf) {
    most = std::max(most, leaf->getLogOdds());
  }
  EXPECT_EQ(tree->getRoot()->getLogOdds(), most);
}

TEST_F(VoxelWriter, OpenvdbReadsEveryLogOddsBack) {
  const OccupancyMap map = room();
  const auto grid = read_vdb(written(map, "room.vdb"));
  ASSERT_NE(grid, nullptr);
  const Beliefs beliefs = beliefs_of(map);
  EXPECT_EQ(grid->activeVoxelCount(), beliefs.size());
  const auto accessor = grid->getConstAccessor();
  for (const auto& [voxel, value] : beliefs) {
    const openvdb::Coord at(voxel.x, voxel.y, voxel.z);
    ASSERT_TRUE(accessor.isValueOn(at)) << at;
    ASSERT_EQ(accessor.getValue(at), static_cast<float>(map.steps().unit * value)) << at;
  }
  EXPECT_EQ(grid->background(), 0.0F);
  EXPECT_EQ(grid->metaValue<std::string>("frame"), "level");
  EXPECT_DOUBLE_EQ(grid->metaValue<double>("resolution"), 0.1);
}

TEST_F(VoxelWriter, OpenvdbPutsVoxelsWhereTheMapHasThem) {
  const OccupancyGeometry shifted{{0.3, -0.2, 0.07}, {0.2, 0.1, 0.05}, std::nullopt};
  for (const OccupancyGeometry& geometry : {tenth, shifted}) {
    const auto grid = read_vdb(written(room(geometry), "room.vdb"));
    for (const Voxel& voxel : {Voxel{0, 0, 0}, Voxel{7, -3, 11}, Voxel{-20, 5, 1}}) {
      const auto world = grid->indexToWorld(openvdb::Coord(voxel.x, voxel.y, voxel.z));
      const Eigen::Vector3d center = voxel_center(geometry, voxel);
      EXPECT_NEAR((Eigen::Vector3d(world.x(), world.y(), world.z()) - center).norm(), 0.0, 1e-9);
    }
  }
}

TEST_F(VoxelWriter, CloudsHoldTheOccupiedVoxels) {
  const OccupancyMap map = room();
  for (const char* name : {"room.pcd", "room.ply"}) {
    const CloudTable cloud = read_cloud(written(map, name));
    Beliefs occupied = beliefs_of(map);
    std::erase_if(occupied, [&](const auto& entry) { return !map.is_occupied(entry.first); });
    ASSERT_EQ(cloud.rows.size(), occupied.size()) << name;
    for (std::size_t i = 0; i < cloud.rows.size(); ++i) {
      const Eigen::Vector3d center(cloud.at(i, "x"), cloud.at(i, "y"), cloud.at(i, "z"));
      const auto voxel = voxel_at(map.geometry(), center);
      ASSERT_TRUE(voxel && occupied.contains(*voxel)) << center.transpose();
      EXPECT_NEAR((voxel_center(map.geometry(), *voxel) - center).norm(), 0.0, 1e-6);
      EXPECT_NEAR(cloud.at(i, "intensity"),
                  map.steps().probability(occupied.extract(*voxel).mapped()),
                  1e-6);
    }
    EXPECT_THAT(file_text(path(name)).substr(0, 200), HasSubstr("frame level"));
  }
}

TEST_F(VoxelWriter, TheSameMapIsTheSameBytes) {
  for (const std::string& ending : endings) {
    EXPECT_EQ(file_text(written(room(), "a" + ending)), file_text(written(room(), "b" + ending)))
        << ending;
  }
}

/// The room's columns west and east of the middle, cut where no tile is.
std::vector<OccupancyMap> halves_of_room() {
  std::vector<OccupancyMap> halves;
  for (const bool west : {true, false}) {
    halves.push_back(room());
    TileBox box;
    (west ? box.x_end : box.x_first) = 0;
    halves.back().restrict_to(box);
  }
  return halves;
}

TEST_F(VoxelWriter, TreesAreTheSameWhateverPartsTheyCameIn) {
  const std::vector<OccupancyMap> halves = halves_of_room();
  for (const OccupancyMap& half : halves) ASSERT_GT(half.block_count(), 100U);
  for (const char* ending : {".bt", ".ot", ".vdb"}) {
    VoxelWriterOptions options;
    options.geometry = tenth;
    options.frame = "level";
    const auto writer = open_voxel_writer(path(std::string("parts") + ending), options);
    for (const OccupancyMap& half : halves) writer->add(half);
    writer->finish();
    EXPECT_EQ(file_text(path(std::string("parts") + ending)),
              file_text(written(room(), std::string("whole") + ending)))
        << ending;
  }
}

TEST_F(VoxelWriter, AnEmptyMapIsAnEmptyFile) {
  const OccupancyMap map(tenth);
  for (const char* name : {"empty.bt", "empty.ot"}) {
    const auto tree = read_octree(written(map, name));
    ASSERT_NE(tree, nullptr) << name;
    EXPECT_EQ(tree->size(), 0U) << name;
  }
  EXPECT_EQ(read_vdb(written(map, "empty.vdb"))->activeVoxelCount(), 0U);
  EXPECT_TRUE(read_cloud(written(map, "empty.pcd")).rows.empty());
}

/// One voxel that was hit.
OccupancyMap spot(const Eigen::Vector3d& place) {
  OccupancyMap map(tenth);
  ThreadPool pool(1);
  map.add(TestScan({{{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}}}, place).scan, pool);
  return map;
}

TEST_F(VoxelWriter, OctomapReachesAsFarAsItSays) {
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(3276.75, -3276.75, 0.05), Eigen::Vector3d(-3276.75, 0.05, 3276.75)}) {
    const OccupancyMap map = spot(place);
    const auto tree = read_octree(written(map, "far.bt"));
    EXPECT_EQ(voxels_of<bool>(*tree, [](const auto&) { return true; }), occupied_of(map));
  }
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(3276.85, 0.0, 0.0), Eigen::Vector3d(0.0, 0.0, -3276.85)}) {
    for (const char* name : {"beyond.bt", "beyond.ot"}) {
      try {
        write_voxels(spot(place), path(name));
        ADD_FAILURE() << name;
      } catch (const Error& error) {
        EXPECT_EQ(error.fault(), Fault::usage);
        EXPECT_THAT(error.what(), HasSubstr("--resolution"));
      }
    }
    EXPECT_EQ(read_vdb(written(spot(place), "beyond.vdb"))->activeVoxelCount(), 1U);
  }
  EXPECT_EQ(files(), 2U);  // far.bt and beyond.vdb
}

TEST_F(VoxelWriter, RefusesWhatAFormatCannotHold) {
  const OccupancyMap flat = room({{0.0, 0.0, 0.0}, {0.1, 0.1, 0.2}, std::nullopt});
  const OccupancyMap moved = room({{0.05, 0.0, 0.0}, {0.1, 0.1, 0.1}, std::nullopt});
  EXPECT_THROW(write_voxels(flat, path("a.bt")), Error);
  EXPECT_THROW(write_voxels(moved, path("a.ot")), Error);
  for (const char* name : {"a", "a.las", "a.octomap", ".bt"}) {
    EXPECT_THROW(write_voxels(room(), path(name)), Error) << name;
  }
  EXPECT_EQ(files(), 0U);
}

TEST_F(VoxelWriter, AFullDiskLeavesWhatWasThere) {
  for (const std::string& ending : endings) {
    std::ofstream(path("map" + ending)) << "before";
    const FileSizeLimit full(1000);
    try {
      write_voxels(room(), path("map" + ending));
      ADD_FAILURE() << ending;
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::output) << ending;
    }
    EXPECT_EQ(file_text(path("map" + ending)), "before");
  }
  EXPECT_EQ(files(), endings.size());
}

TEST_F(VoxelWriter, ToolsOfBothLibrariesReadTheFiles) {
  const OccupancyMap map = room();
  const ProgramResult octomap =
      run_program({"convert_octree", written(map, "room.bt"), path("again.ot")});
  ASSERT_EQ(octomap.exit_code, 0) << octomap.err;
  const auto tree = read_octree(path("again.ot"));
  const auto found = voxels_of<bool>(
      *tree, [&](const octomap::OcTreeNode& leaf) { return tree->isNodeOccupied(leaf); });
  EXPECT_TRUE(found == occupied_of(map));
  const ProgramResult vdb = run_program({"vdb_print", "-l", written(map, "room.vdb")});
  ASSERT_EQ(vdb.exit_code, 0) << vdb.err;
  EXPECT_THAT(vdb.out, HasSubstr("occupancy"));
  EXPECT_THAT(vdb.out, HasSubstr("log-odds"));
}

}  // namespace
}  // namespace kissmap
