// SPDX-License-Identifier: MIT
#include "kissmap/cloud/thinned_cloud.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr std::size_t first_table_size = 1024;
constexpr int normal_reach = 2;  // voxels to each side
constexpr std::size_t fewest_for_normal = 5;
constexpr double thinnest_patch = 1e-3;  // of its length squared, or else it is a line
constexpr std::size_t normals_per_chunk = 4096;

const Eigen::Vector3f no_normal =
    Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

Error too_fine(double voxel_size, const Eigen::Vector3d& position) {
  return usage_error("--voxel-size " + std::to_string(voxel_size) +
                     ": too small for a map that reaches " +
                     std::to_string(position.cwiseAbs().maxCoeff()) +
                     " m from its origin; take larger voxels, or crop the map");
}

Voxel block_of(const Voxel& voxel) {
  return {voxel.x >> 2, voxel.y >> 2, voxel.z >> 2};
}

Voxel first_voxel(const Voxel& block) {
  return {4 * block.x, 4 * block.y, 4 * block.z};
}

std::size_t place_in_block(const Voxel& voxel) {
  return static_cast<std::size_t>((voxel.x & 3) | (voxel.y & 3) << 2 | (voxel.z & 3) << 4);
}

Voxel moved(const Voxel& voxel, int by) {
  return {voxel.x + by, voxel.y + by, voxel.z + by};
}

Voxel highest(const Voxel& a, const Voxel& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

Voxel lowest(const Voxel& a, const Voxel& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

/// All from `low` to `high`, both included.
template <class Visit>
void for_each_voxel(const Voxel& low, const Voxel& high, Visit&& visit) {
  for (int z = low.z; z <= high.z; ++z) {
    for (int y = low.y; y <= high.y; ++y) {
      for (int x = low.x; x <= high.x; ++x) visit(Voxel{x, y, z});
    }
  }
}

/// How points scatter about their mean.
struct Spread {
  std::size_t count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

  void add(const Eigen::Vector3d& point) {
    sum += point;
    squares += point * point.transpose();
    ++count;
  }

  /// Unit length; NaN where points are few or on one line.
  Eigen::Vector3f least_direction() const {
    if (count < fewest_for_normal) return no_normal;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(squares - sum * sum.transpose() / static_cast<double>(count));
    if (solver.eigenvalues()(1) < thinnest_patch * solver.eigenvalues()(2)) return no_normal;
    return solver.eigenvectors().col(0).cast<float>();
  }
};

std::int32_t floor_index(double coordinate, double voxel_size) {
  return static_cast<std::int32_t>(std::floor(coordinate / voxel_size));
}

}  // namespace

ThinnedCloud::ThinnedCloud(double voxel_size) : voxel_size_(voxel_size), table_(first_table_size) {
}

Voxel ThinnedCloud::voxel_at(const Eigen::Vector3d& position) const {
  constexpr double reach = (1 << 20) - 1 - normal_reach;
  if (!(position.cwiseAbs().maxCoeff() < reach * voxel_size_)) {
    throw too_fine(voxel_size_, position);
  }
  return {floor_index(position.x(), voxel_size_),
          floor_index(position.y(), voxel_size_),
          floor_index(position.z(), voxel_size_)};
}

Eigen::Vector3f ThinnedCloud::in_voxel(const Eigen::Vector3d& position, const Voxel& voxel) const {
  return (position - voxel_size_ * Eigen::Vector3d(voxel.x, voxel.y, voxel.z)).cast<float>();
}

std::size_t ThinnedCloud::slot_of(VoxelKey key) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = voxel_hash(key, static_cast<unsigned>(std::countr_zero(table_.size())));
  while (table_[slot] != 0 && blocks_[table_[slot] - 1].key != key) slot = (slot + 1) & mask;
  return slot;
}

const ThinnedCloud::Block* ThinnedCloud::find_block(const Voxel& block) const {
  const std::uint32_t entry = table_[slot_of(voxel_key(block))];
  return entry == 0 ? nullptr : &blocks_[entry - 1];
}

ThinnedCloud::Block& ThinnedCloud::block_at(const Voxel& block) {
  const VoxelKey key = voxel_key(block);
  std::uint32_t& entry = table_[slot_of(key)];
  if (entry != 0) return blocks_[entry - 1];
  blocks_.emplace_back().key = key;
  entry = static_cast<std::uint32_t>(blocks_.size());
  if (2 * blocks_.size() > table_.size()) grow();
  return blocks_.back();
}

void ThinnedCloud::grow() {
  table_.assign(2 * table_.size(), 0);
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    table_[slot_of(blocks_[i].key)] = static_cast<std::uint32_t>(i + 1);
  }
}

ThinnedCloud::Cell& ThinnedCloud::cell_at(const Voxel& voxel) {
  std::uint32_t& entry = block_at(block_of(voxel)).cells[place_in_block(voxel)];
  if (entry != 0) return cells_[entry - 1];
  if (cells_.size() >= std::numeric_limits<std::uint32_t>::max() - 1) {
    throw Error(Fault::internal, "more voxels than can be counted; take larger ones");
  }
  cells_.emplace_back().key = voxel_key(voxel);
  entry = static_cast<std::uint32_t>(cells_.size());
  return cells_.back();
}

void ThinnedCloud::add(const MapPoint& point) {
  const Voxel voxel = voxel_at(point.position);
  Cell& cell = cell_at(voxel);
  ++points_added_;
  ++cell.count;
  const Eigen::Vector3f place = in_voxel(point.position, voxel);
  cell.mean += (place - cell.mean) / static_cast<float>(cell.count);
  const Eigen::Vector3f kept = in_voxel(cell.point.position, voxel);
  const bool nearer = (place - cell.mean).squaredNorm() < (kept - cell.mean).squaredNorm();
  // Two points are equally far from their mean; which is nearer would be a matter of rounding.
  if (cell.count == 1 || (cell.count > 2 && nearer)) cell.point = point;
}

Eigen::Vector3f ThinnedCloud::normal_at(const Cell& cell) const {
  const Voxel centre = voxel_from_key(cell.key);
  const Voxel low = moved(centre, -normal_reach);
  const Voxel high = moved(centre, normal_reach);
  Spread spread;
  for_each_voxel(block_of(low), block_of(high), [&](const Voxel& at) {
    const Block* block = find_block(at);
    if (block == nullptr) return;
    const Voxel begin = first_voxel(at);
    for_each_voxel(highest(low, begin), lowest(high, moved(begin, 3)), [&](const Voxel& voxel) {
      const std::uint32_t entry = block->cells[place_in_block(voxel)];
      if (entry == 0) return;
      spread.add(cells_[entry - 1].mean.cast<double>() / voxel_size_ +
                 Eigen::Vector3d(voxel.x - centre.x, voxel.y - centre.y, voxel.z - centre.z));
    });
  });
  const Eigen::Vector3f normal = spread.least_direction();
  return normal.dot(cell.point.to_sensor) < 0.0F ? Eigen::Vector3f(-normal) : normal;
}

std::vector<Eigen::Vector3f> ThinnedCloud::normals(ThreadPool& pool) const {
  std::vector<Eigen::Vector3f> all(cells_.size());
  const std::size_t chunks = (all.size() + normals_per_chunk - 1) / normals_per_chunk;
  pool.for_each_chunk(chunks, [&](std::size_t chunk) {
    const std::size_t end = std::min(all.size(), (chunk + 1) * normals_per_chunk);
    for (std::size_t i = chunk * normals_per_chunk; i < end; ++i) all[i] = normal_at(cells_[i]);
  });
  return all;
}

}  // namespace kissmap
