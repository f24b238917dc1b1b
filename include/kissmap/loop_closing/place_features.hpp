// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "kissmap/loop_closing/density_image.hpp"

namespace kissmap {

/// 256 bits of an ORB descriptor.
using Descriptor = std::array<std::uint64_t, 4>;

/// Number of bits in which two descriptors differ, 0..256.
inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

/// What a place looks like from above at one pixel size.
struct PlaceFeatures {
  std::vector<Eigen::Vector2f> positions;  ///< m, ground frame, one a descriptor
  std::vector<Descriptor> descriptors;

  std::size_t size() const { return descriptors.size(); }
};

/// ORB (Rublee et al. 2011; OpenCV) with METHOD 3.3's settings: at most 500 features, one pyramid
/// level, FAST threshold 35, patch of 31 pixels. A descriptor with another one of the same image
/// within 35 bits is dropped as self-similar. An empty or featureless image has no features.
/// Pure; the same for any number of threads.
PlaceFeatures place_features(const DensityImage& image);

}  // namespace kissmap
