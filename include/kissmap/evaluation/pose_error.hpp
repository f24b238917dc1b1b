// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// What a list of errors comes to. Of an empty list: count 0 and zeros.
struct ErrorStatistics {
  std::size_t count = 0;
  double rmse = 0.0;  ///< root of the mean square
  double mean = 0.0;
  double median = 0.0;  ///< mean of the middle two of an even count
  double std = 0.0;     ///< root of the mean square deviation from the mean (divides by count)
  double min = 0.0;
  double max = 0.0;
};
ErrorStatistics statistics(const std::vector<double>& errors);

/// An error for each pose or pair of poses.
struct PoseErrors {
  std::vector<double> translation;  ///< m
  std::vector<double> rotation;     ///< rad, 0..pi
};

/// Absolute trajectory error (evo: APE): distance of positions, and angle of the rotation
/// estimate[i]^-1 * reference[i]. Both lists in one frame and equally long.
PoseErrors absolute_error(const std::vector<Rigid3>& reference,
                          const std::vector<Rigid3>& estimate);

enum class DeltaUnit { frames, metres, seconds };

/// How far apart the two poses of a pair are.
struct Delta {
  double value = 1.0;
  DeltaUnit unit = DeltaUnit::frames;
};
/// Throws Error(usage) unless positive and finite, and whole for frames.
void require_valid(const Delta& delta);

enum class PairChoice {
  consecutive,  ///< each pair begins where the one before ends
  all,          ///< a pair begins at each pose
};

/// Pairs of indices (i, j), i < j, ascending. As evo chooses them for frames and metres
/// (evo/core/filters.py):
/// - frames: j = i + delta; consecutive ones start at pose 0.
/// - metres, along the way: consecutive, a mark falls on the first pose that is delta or more
///   behind the mark before (the first mark: behind pose 0), and pairs join the marks; all, j is
///   the pose whose way from i is nearest to delta, if it is within a tenth of delta.
/// - seconds (not in evo): j is the pose whose stamp is nearest to that of i plus delta, if it is
///   within a tenth of delta; consecutive ones start at pose 0 and step over poses without a pair.
///   Throws Error(usage) without stamps.
std::vector<std::pair<std::size_t, std::size_t>> choose_pairs(
    const std::vector<Rigid3>& poses,
    const std::vector<std::int64_t>& stamps_ns,
    const Delta& delta,
    PairChoice choice);

/// Relative pose error (Sturm et al., IROS 2012, eq. 2; evo: RPE) of pairs (i, j): translation and
/// angle of (reference[i]^-1 reference[j])^-1 (estimate[i]^-1 estimate[j]). Needs no alignment.
PoseErrors relative_error(const std::vector<Rigid3>& reference,
                          const std::vector<Rigid3>& estimate,
                          const std::vector<std::pair<std::size_t, std::size_t>>& pairs);

}  // namespace kissmap
