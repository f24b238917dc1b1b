// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/surfel_registration.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <unordered_set>

#include "nearest_bound.hpp"

namespace kissmap {
namespace {

constexpr std::size_t max_samples = 2500;
constexpr int max_iterations_coarse = 20;
constexpr int max_iterations_fine = 40;
constexpr double min_translation = 1e-3;  // m, convergence
constexpr double min_rotation = 1e-4;     // rad
constexpr double min_normal_agreement = 0.7;
constexpr double coarseness = 3.0;      // coarse voxel over fine voxel
constexpr double residual_scale = 0.3;  // of a voxel, of the kernel
constexpr double damping = 1e-3;
constexpr int min_pairs = 20;
// What a registration is worth, see information_of().
constexpr double independent_pairs = 100.0;
constexpr double pair_sigma = 0.03;            // m
constexpr double least_share_of_faces = 0.05;  // of the planes, that a direction needs

/// From which side pairs of surfels have to be seen.
enum class Sides : std::uint8_t { any, same };

/// A guess that is weighed beside the pairs.
struct Prior {
  Rigid3 reference_from_query;
  Twist information;  ///< of each direction: 1 / variance
};

struct Sums {
  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
  Twist gradient = Twist::Zero();
  double squares = 0.0;  // unweighted, of pairs within the kernel's reach
  double weights = 0.0;
  int pairs = 0;
};

/// A share of the surfels, evenly picked.
SurfelCloud sample(const SurfelCloud& surfels, std::size_t most) {
  if (surfels.size() <= most) return surfels;
  SurfelCloud samples;
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t at = i * surfels.size() / most;
    samples.means.push_back(surfels.means[at]);
    samples.normals.push_back(surfels.normals[at]);
  }
  return samples;
}

Sums accumulate(const SurfelCloud& samples,
                const SurfelMap& reference,
                NearestSurfels& surfels,
                const Rigid3& reference_from_query,
                double reach,
                Sides sides = Sides::any) {
  const Eigen::Matrix3d rotation = reference_from_query.rotation.toRotationMatrix();
  const double scale = residual_scale * reference.voxel_size();
  Sums sums;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d point = samples.means[i].cast<double>();
    const Eigen::Vector3d moved = rotation * point + reference_from_query.translation;
    const std::int32_t nearest = surfels.of(i, moved.cast<float>());
    if (nearest < 0) continue;
    const auto match = static_cast<std::size_t>(nearest);
    const Eigen::Vector3d apart = moved - reference.surfels().means[match].cast<double>();
    if (apart.squaredNorm() > reach * reach) continue;
    const Eigen::Vector3d normal = reference.surfels().normals[match].cast<double>();
    if (!samples.normals.empty()) {
      const Eigen::Vector3d own_normal = rotation * samples.normals[i].cast<double>();
      const double agreement = normal.dot(own_normal);
      if ((sides == Sides::same ? agreement : std::abs(agreement)) < min_normal_agreement) continue;
    }
    const double residual = normal.dot(apart);
    const double weight =
        scale * scale /
        ((scale + residual * residual / scale) * (scale + residual * residual / scale));
    // reference_from_query * exp(twist): the derivative of n' (R (p + v + w x p) + t).
    const Eigen::Vector3d turned = rotation.transpose() * normal;
    Twist jacobian;
    jacobian << turned, point.cross(turned);
    sums.hessian += weight * jacobian * jacobian.transpose();
    sums.gradient += weight * residual * jacobian;
    sums.squares += residual * residual;
    sums.weights += weight;
    ++sums.pairs;
  }
  return sums;
}

double rms(const Sums& sums) {
  return sums.pairs > 0 ? std::sqrt(sums.squares / sums.pairs) : 0.0;
}

/// Iterates `alignment` at one resolution, on all surfels or only those seen from the same side.
void refine(const SurfelCloud& samples,
            const SurfelMap& reference,
            double reach,
            int max_iterations,
            SurfelAlignment& alignment,
            const Prior* prior = nullptr,
            Sides sides = Sides::any) {
  alignment.converged = false;
  NearestSurfels nearest(reference, samples.size());
  for (int i = 0; i < max_iterations; ++i) {
    const Sums sums =
        accumulate(samples, reference, nearest, alignment.reference_from_query, reach, sides);
    alignment.pairs = sums.pairs;
    alignment.residual_after = rms(sums);
    alignment.hessian = sums.hessian;
    if (alignment.iterations == 0) alignment.residual_before = alignment.residual_after;
    if (sums.pairs < min_pairs) return;
    ++alignment.iterations;
    // Keeps steps short along directions that nothing binds, as along a bare corridor.
    Eigen::Matrix<double, 6, 6> damped = sums.hessian;
    damped.diagonal().head<3>().array() += damping * sums.hessian.diagonal().head<3>().mean();
    damped.diagonal().tail<3>().array() += damping * sums.hessian.diagonal().tail<3>().mean();
    Twist gradient = sums.gradient;
    if (prior != nullptr) {
      const Twist weight =
          sums.pairs * pair_sigma * pair_sigma / independent_pairs * prior->information;
      damped.diagonal() += weight;
      gradient += weight.cwiseProduct(
          log(prior->reference_from_query.inverse() * alignment.reference_from_query));
    }
    const Twist step = damped.ldlt().solve(-gradient);
    if (!step.allFinite()) return;
    alignment.reference_from_query = alignment.reference_from_query * exp(step);
    if (step.head<3>().norm() < min_translation && step.tail<3>().norm() < min_rotation) {
      alignment.converged = true;
      return;
    }
  }
}

constexpr unsigned block_bits = 2;  // 4 voxels along an edge
constexpr std::uint32_t in_block = (1U << block_bits) - 1;

Voxel block_of(const Voxel& voxel) {
  return {voxel.x >> block_bits, voxel.y >> block_bits, voxel.z >> block_bits};
}

std::uint64_t bit_of(const Voxel& voxel) {
  const auto along = [](std::int32_t i) { return static_cast<std::uint32_t>(i) & in_block; };
  return std::uint64_t{1} << (along(voxel.x) + 4 * along(voxel.y) + 16 * along(voxel.z));
}

/// Number of bits below that one.
std::size_t rank(std::uint64_t bits, std::uint64_t bit) {
  return static_cast<std::size_t>(std::popcount(bits & (bit - 1)));
}

/// Bits of one axis, 0..3, of the voxels before, at and after `center` that lie in a block.
std::uint32_t bits_along(std::int32_t center, std::int32_t block) {
  const std::int32_t before = center - 1 - (block << block_bits);  // -3..4
  return (before >= 0 ? 7U << before : 7U >> -before) & 15U;
}

/// For each of 16 sets of bits 0..3: bit i moved to i * step.
constexpr std::array<std::uint64_t, 16> spread(unsigned step) {
  std::array<std::uint64_t, 16> sets{};
  for (unsigned set = 0; set < sets.size(); ++set) {
    for (unsigned i = 0; i < 4; ++i) sets[set] |= std::uint64_t{(set >> i) & 1U} << (i * step);
  }
  return sets;
}

/// Voxels of a block among the 27 around one, as bits.
std::uint64_t bits_around(const Voxel& center, const Voxel& block) {
  static constexpr auto rows = spread(4);
  static constexpr auto layers = spread(16);
  return bits_along(center.x, block.x) * rows[bits_along(center.y, block.y)] *
         layers[bits_along(center.z, block.z)];
}

}  // namespace

SurfelMap::SurfelMap(const SurfelCloud& surfels, double voxel_size)
    : voxel_size_(voxel_size), per_metre_(static_cast<float>(1.0 / voxel_size)) {
  bits_ = static_cast<unsigned>(std::bit_width(2 * surfels.size() + 2));
  table_.resize(std::size_t{1} << bits_);
  struct Kept {
    std::size_t surfel;
    std::size_t slot;
    std::uint64_t bit;
  };
  std::vector<Kept> kept;
  std::vector<std::size_t> slots;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Voxel voxel = voxel_of(surfels.means[i], per_metre_);
    const VoxelKey key = voxel_key(block_of(voxel));
    const std::size_t slot = slot_of(key);
    Block& block = table_[slot];
    if (block.key == no_voxel) {
      block.key = key;
      slots.push_back(slot);
    }
    const std::uint64_t bit = bit_of(voxel);
    if ((block.voxels & bit) != 0) continue;
    block.voxels |= bit;
    kept.push_back({i, slot, bit});
  }
  std::uint32_t count = 0;
  for (const std::size_t slot : slots) {
    table_[slot].surfels = count;
    count += static_cast<std::uint32_t>(std::popcount(table_[slot].voxels));
  }
  surfels_.means.resize(count);
  surfels_.normals.resize(count);
  for (const Kept& one : kept) {
    const Block& block = table_[one.slot];
    const std::size_t to = block.surfels + rank(block.voxels, one.bit);
    surfels_.means[to] = surfels.means[one.surfel];
    surfels_.normals[to] = surfels.normals[one.surfel];
  }
}

std::size_t SurfelMap::slot_of(VoxelKey block) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = voxel_hash(block, bits_);
  while (table_[slot].key != no_voxel && table_[slot].key != block) slot = (slot + 1) & mask;
  return slot;
}

SurfelMap::Nearest SurfelMap::nearest(const Eigen::Vector3f& point) const {
  const Voxel center = voxel_of(point, per_metre_);
  const Voxel first = block_of({center.x - 1, center.y - 1, center.z - 1});
  const Voxel last = block_of({center.x + 1, center.y + 1, center.z + 1});
  std::int32_t best = -1;
  float best_squared = std::numeric_limits<float>::infinity();
  float next_squared = best_squared;
  for (std::int32_t x = first.x; x <= last.x; ++x) {
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      for (std::int32_t z = first.z; z <= last.z; ++z) {
        const Block& block = table_[slot_of(voxel_key({x, y, z}))];
        std::uint64_t around = block.voxels & bits_around(center, {x, y, z});
        for (; around != 0; around &= around - 1) {
          const std::uint64_t bit = around & (~around + 1);
          const std::size_t at = block.surfels + rank(block.voxels, bit);
          const float squared = (surfels_.means[at] - point).squaredNorm();
          if (squared >= best_squared) {
            next_squared = std::min(next_squared, squared);
            continue;
          }
          next_squared = best_squared;
          best_squared = squared;
          best = static_cast<std::int32_t>(at);
        }
      }
    }
  }
  return {best, std::sqrt(best_squared), std::sqrt(next_squared)};
}

NearestSurfels::NearestSurfels(const SurfelMap& reference, std::size_t samples)
    : reference_(reference), found_(samples) {
}

std::int32_t NearestSurfels::of(std::size_t sample, const Eigen::Vector3f& point) {
  Found& found = found_[sample];
  const VoxelKey voxel = reference_.voxel_at(point);
  if (voxel != found.voxel || !still_nearest(found, point)) {
    found = {voxel, point, reference_.nearest(point)};
  }
  return found.nearest.surfel;
}

// Of a point in the same voxel: it came nearer to others by no more than it moved.
bool NearestSurfels::still_nearest(const Found& found, const Eigen::Vector3f& point) const {
  if (found.nearest.surfel < 0) return true;
  const auto surfel = static_cast<std::size_t>(found.nearest.surfel);
  const float distance = (reference_.surfels().means[surfel] - point).norm();
  return distance < others_beyond(found.nearest.next_distance, (point - found.point).norm());
}

bool SurfelMap::occupied(const Eigen::Vector3f& point) const {
  const Voxel voxel = voxel_of(point, per_metre_);
  return (table_[slot_of(voxel_key(block_of(voxel)))].voxels & bit_of(voxel)) != 0;
}

SurfelReference::SurfelReference(const SurfelCloud& surfels, double voxel_size)
    : fine_(surfels, voxel_size), coarse_(surfels, coarseness * voxel_size) {
}

SurfelAlignment register_surfels(const SurfelCloud& query,
                                 const SurfelReference& reference,
                                 const Rigid3& guess_reference_from_query) {
  SurfelAlignment alignment;
  alignment.reference_from_query = guess_reference_from_query;
  const SurfelCloud samples = sample(query, max_samples);
  alignment.samples = static_cast<int>(samples.size());
  const double voxel = reference.fine().voxel_size();
  const double reach = std::numbers::sqrt3 * voxel;
  refine(samples, reference.coarse(), coarseness * voxel, max_iterations_coarse, alignment);
  // In narrow places coarse pairs join opposite walls: a guess that fits better is kept.
  const auto fit = [&](const Rigid3& reference_from_query) {
    NearestSurfels nearest(reference.fine(), samples.size());
    return accumulate(samples, reference.fine(), nearest, reference_from_query, reach).weights;
  };
  if (fit(guess_reference_from_query) > fit(alignment.reference_from_query)) {
    alignment.reference_from_query = guess_reference_from_query;
  }
  refine(samples, reference.fine(), reach, max_iterations_fine, alignment);
  return alignment;
}

SurfelAlignment register_nearby(const SurfelCloud& query,
                                const SurfelMap& reference,
                                const Rigid3& guess_reference_from_query,
                                std::size_t samples) {
  SurfelAlignment alignment;
  alignment.reference_from_query = guess_reference_from_query;
  const SurfelCloud picked = sample(query, samples);
  alignment.samples = static_cast<int>(picked.size());
  const double reach = std::numbers::sqrt3 * reference.voxel_size();
  refine(picked, reference, reach, max_iterations_fine, alignment, nullptr, Sides::same);
  return alignment;
}

SurfelAlignment register_points(std::span<const Eigen::Vector3f> points_in_query,
                                const SurfelMap& reference,
                                const Rigid3& guess_reference_from_query,
                                const GuessSigmas& sigmas) {
  SurfelAlignment alignment;
  alignment.reference_from_query = guess_reference_from_query;
  SurfelCloud points;
  points.means.assign(points_in_query.begin(), points_in_query.end());
  alignment.samples = static_cast<int>(points.size());
  Prior prior{guess_reference_from_query, Twist::Zero()};
  prior.information.head<3>().setConstant(1.0 / (sigmas.metres * sigmas.metres));
  prior.information.tail<3>().setConstant(1.0 / (sigmas.radians * sigmas.radians));
  const double reach = std::numbers::sqrt3 * reference.voxel_size();
  refine(points, reference, reach, max_iterations_fine, alignment, &prior);
  return alignment;
}

Eigen::Matrix<double, 6, 6> information_of(const SurfelAlignment& alignment) {
  Eigen::Matrix<double, 6, 6> hessian = alignment.hessian;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> faces(
      Eigen::Matrix3d(hessian.topLeftCorner<3, 3>()));
  for (int i = 0; i < 3; ++i) {
    if (faces.eigenvalues()(i) >= least_share_of_faces * alignment.pairs) continue;
    Twist open = Twist::Zero();
    open.head<3>() = faces.eigenvectors().col(i);
    const Eigen::Matrix<double, 6, 6> others =
        Eigen::Matrix<double, 6, 6>::Identity() - open * open.transpose();
    hessian = others * hessian * others;
  }
  Eigen::Matrix<double, 6, 6> information =
      0.5 * independent_pairs / alignment.pairs / (pair_sigma * pair_sigma) *
      (hessian + hessian.transpose());     // to the last bit, as what is written and read back
  information.diagonal().array() += 1e-6;  // never singular
  return information;
}

double overlap(const SurfelCloud& query,
               const SurfelMap& reference,
               const Rigid3& reference_from_query) {
  const std::size_t smaller = std::min(query.size(), reference.surfels().size());
  if (smaller == 0) return 0.0;
  const Eigen::Matrix4f transform = reference_from_query.matrix().cast<float>();
  const auto per_metre = static_cast<float>(1.0 / reference.voxel_size());
  std::unordered_set<VoxelKey> shared;
  for (const Eigen::Vector3f& mean : query.means) {
    const Eigen::Vector3f moved =
        transform.topLeftCorner<3, 3>() * mean + transform.topRightCorner<3, 1>();
    if (reference.occupied(moved)) shared.insert(voxel_key(voxel_of(moved, per_metre)));
  }
  return static_cast<double>(shared.size()) / static_cast<double>(smaller);
}

}  // namespace kissmap
