// SPDX-License-Identifier: MIT
#include "kissmap/odometry/voxel_hash_map.hpp"

#include <algorithm>
#include <cmath>

namespace kissmap {
namespace {

constexpr unsigned initial_bits = 12;
constexpr std::size_t batch = 32;  // points

// Rounding may put a point one voxel off by at most this share of a voxel.
constexpr float voxel_slack = 1e-3F;

struct Offset {
  std::int8_t x, y, z;
};

// The 27 voxels around a query, nearer ones first: centre, faces, edges, corners.
constexpr std::array<Offset, 27> neighborhood{
    {{0, 0, 0},   {1, 0, 0},   {-1, 0, 0}, {0, 1, 0},   {0, -1, 0},  {0, 0, 1},   {0, 0, -1},
     {1, 1, 0},   {1, -1, 0},  {-1, 1, 0}, {-1, -1, 0}, {1, 0, 1},   {1, 0, -1},  {-1, 0, 1},
     {-1, 0, -1}, {0, 1, 1},   {0, 1, -1}, {0, -1, 1},  {0, -1, -1}, {1, 1, 1},   {1, 1, -1},
     {1, -1, 1},  {1, -1, -1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, 1}, {-1, -1, -1}}};

// Squared distance along one axis from a query to the voxels below, at and above its own.
// `inside` is the query's position in its voxel, 0..1.
std::array<float, 3> squared_gaps(float inside, float voxel_size) {
  const float below = std::max(0.0F, inside - voxel_slack) * voxel_size;
  const float above = std::max(0.0F, 1.0F - inside - voxel_slack) * voxel_size;
  return {below * below, 0.0F, above * above};
}

}  // namespace

VoxelHashMap::VoxelHashMap(double voxel_size, int max_points_per_voxel)
    : voxel_size_(voxel_size),
      per_metre_(static_cast<float>(1.0 / voxel_size)),
      max_points_(static_cast<std::uint32_t>(std::clamp(max_points_per_voxel, 1, capacity))),
      min_spacing_squared_(static_cast<float>(voxel_size * voxel_size / max_points_)),
      table_(std::size_t{1} << initial_bits),
      bits_(initial_bits) {
}

// Points come from all over the map: while some are added, the memory of those after them is on
// its way.
void VoxelHashMap::add(std::span<const Eigen::Vector3f> points) {
  std::array<VoxelKey, batch> keys;
  std::array<Entry*, batch> entries;
  while (!points.empty()) {
    const std::size_t n = std::min(points.size(), batch);
    while (2 * (voxel_count_ + n) > table_.size()) grow();
    for (std::size_t i = 0; i < n; ++i) {
      keys[i] = voxel_key(voxel_of(points[i], per_metre_));
      __builtin_prefetch(&table_[voxel_hash(keys[i], bits_)]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      entries[i] = &find_or_insert(keys[i]);
      if (entries[i]->count < max_points_) prefetch(block(entries[i]->block));
    }
    for (std::size_t i = 0; i < n; ++i) add(points[i], *entries[i]);
    points = points.subspan(n);
  }
}

void VoxelHashMap::add(const Eigen::Vector3f& point, Entry& entry) {
  if (entry.count == max_points_) return;
  Block& b = block(entry.block);
  float nearest = far_away;
  for (std::uint32_t i = 0; i < capacity; ++i) {
    const float dx = b.x[i] - point.x();
    const float dy = b.y[i] - point.y();
    const float dz = b.z[i] - point.z();
    nearest = std::min(nearest, dx * dx + dy * dy + dz * dz);
  }
  if (nearest < min_spacing_squared_) return;
  b.x[entry.count] = point.x();
  b.y[entry.count] = point.y();
  b.z[entry.count] = point.z();
  b.count = ++entry.count;
}

void VoxelHashMap::remove_farther_than(double distance, const Eigen::Vector3d& center) {
  const double limit = distance * distance;
  for (std::uint32_t i = 0; i < blocks_taken_; ++i) {
    const VoxelKey key = block(i).key;
    if (key == no_voxel) continue;
    const Voxel v = voxel_from_key(key);
    const Eigen::Vector3d voxel_center =
        Eigen::Vector3d(v.x + 0.5, v.y + 0.5, v.z + 0.5) * voxel_size_;
    if ((voxel_center - center).squaredNorm() > limit) erase(key);
  }
}

void VoxelHashMap::clear() {
  std::ranges::fill(table_, Entry{});
  blocks_taken_ = 0;
  free_blocks_.clear();
  voxel_count_ = 0;
}

struct VoxelHashMap::Search {
  Eigen::Vector3f query;
  float best_squared;  // of `best`, or the search radius squared
  float next_squared;  // smallest of everything else seen or skipped
  const Block* best_block = nullptr;
  std::uint32_t best_index = 0;

  void look_at(const Block& b, std::uint32_t count) {
    std::array<float, capacity> squared;
    for (std::uint32_t i = 0; i < capacity; ++i) {
      const float dx = b.x[i] - query.x();
      const float dy = b.y[i] - query.y();
      const float dz = b.z[i] - query.z();
      squared[i] = dx * dx + dy * dy + dz * dz;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      if (squared[i] < best_squared) {
        next_squared = std::min(next_squared, best_squared);
        best_squared = squared[i];
        best_block = &b;
        best_index = i;
      } else {
        next_squared = std::min(next_squared, squared[i]);
      }
    }
  }
};

VoxelHashMap::Neighbor VoxelHashMap::nearest(const Eigen::Vector3f& query,
                                             float max_distance) const {
  const Voxel center = voxel_of(query, per_metre_);
  const auto size = static_cast<float>(voxel_size_);
  const auto gap_x = squared_gaps(query.x() * per_metre_ - static_cast<float>(center.x), size);
  const auto gap_y = squared_gaps(query.y() * per_metre_ - static_cast<float>(center.y), size);
  const auto gap_z = squared_gaps(query.z() * per_metre_ - static_cast<float>(center.z), size);
  Search search{query, max_distance * max_distance, std::numeric_limits<float>::infinity()};
  for (const Offset& o : neighborhood) {
    const float gap = gap_x[static_cast<std::size_t>(o.x + 1)] +
                      gap_y[static_cast<std::size_t>(o.y + 1)] +
                      gap_z[static_cast<std::size_t>(o.z + 1)];
    if (gap >= search.best_squared) {
      search.next_squared = std::min(search.next_squared, gap);
      continue;
    }
    const Entry* entry = find(voxel_key({center.x + o.x, center.y + o.y, center.z + o.z}));
    if (entry != nullptr) search.look_at(block(entry->block), entry->count);
  }
  Neighbor neighbor;
  neighbor.next_distance = std::sqrt(search.next_squared);
  if (search.best_block != nullptr) {
    const Block& b = *search.best_block;
    const std::uint32_t i = search.best_index;
    neighbor.point = {b.x[i], b.y[i], b.z[i]};
    neighbor.found = true;
    neighbor.distance = std::sqrt(search.best_squared);
  }
  return neighbor;
}

std::vector<Eigen::Vector3f> VoxelHashMap::points() const {
  std::vector<Eigen::Vector3f> all;
  all.reserve(voxel_count_ * max_points_ / 2);
  for_each_voxel([&all](std::span<const Eigen::Vector3f> voxel) {
    all.insert(all.end(), voxel.begin(), voxel.end());
  });
  return all;
}

std::size_t VoxelHashMap::memory_bytes() const {
  return table_.capacity() * sizeof(Entry) + pages_.size() * blocks_per_page * sizeof(Block);
}

const VoxelHashMap::Entry* VoxelHashMap::find(VoxelKey key) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t i = voxel_hash(key, bits_);
  while (table_[i].key != key) {
    if (table_[i].key == no_voxel) return nullptr;
    i = (i + 1) & mask;
  }
  return &table_[i];
}

VoxelHashMap::Entry& VoxelHashMap::find_or_insert(VoxelKey key) {
  const std::size_t mask = table_.size() - 1;
  std::size_t i = voxel_hash(key, bits_);
  while (table_[i].key != key) {
    if (table_[i].key == no_voxel) {
      table_[i] = {key, take_block(key), 0};
      ++voxel_count_;
      break;
    }
    i = (i + 1) & mask;
  }
  return table_[i];
}

void VoxelHashMap::erase(VoxelKey key) {
  const std::size_t mask = table_.size() - 1;
  std::size_t hole = voxel_hash(key, bits_);
  while (table_[hole].key != key) hole = (hole + 1) & mask;
  block(table_[hole].block).key = no_voxel;
  free_blocks_.push_back(table_[hole].block);
  --voxel_count_;
  // Close the hole: move back every later entry of the run that may stand there.
  for (std::size_t i = (hole + 1) & mask; table_[i].key != no_voxel; i = (i + 1) & mask) {
    const std::size_t home = voxel_hash(table_[i].key, bits_);
    if (((i - home) & mask) >= ((i - hole) & mask)) {
      table_[hole] = table_[i];
      hole = i;
    }
  }
  table_[hole] = Entry{};
}

void VoxelHashMap::grow() {
  const std::vector<Entry> old = std::move(table_);
  ++bits_;
  table_.assign(std::size_t{1} << bits_, Entry{});
  const std::size_t mask = table_.size() - 1;
  for (const Entry& entry : old) {
    if (entry.key == no_voxel) continue;
    std::size_t i = voxel_hash(entry.key, bits_);
    while (table_[i].key != no_voxel) i = (i + 1) & mask;
    table_[i] = entry;
  }
}

void VoxelHashMap::prefetch(const Block& block) {
  for (std::size_t line = 0; line < sizeof(Block); line += alignof(Block)) {
    __builtin_prefetch(reinterpret_cast<const std::byte*>(&block) + line);
  }
}

std::uint32_t VoxelHashMap::take_block(VoxelKey key) {
  std::uint32_t number = blocks_taken_;
  if (!free_blocks_.empty()) {
    number = free_blocks_.back();
    free_blocks_.pop_back();
  } else {
    if (blocks_taken_ == pages_.size() * blocks_per_page) {
      pages_.push_back(std::make_unique<Block[]>(blocks_per_page));
    }
    ++blocks_taken_;
  }
  Block& b = block(number);
  b.x.fill(far_away);
  b.y.fill(far_away);
  b.z.fill(far_away);
  b.key = key;
  b.count = 0;
  return number;
}

}  // namespace kissmap
