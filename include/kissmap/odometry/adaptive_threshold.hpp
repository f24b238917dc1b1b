// SPDX-License-Identifier: MIT
#pragma once

#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// How far the motion model may be off, learned from how far it was (KISS-ICP, section III-C):
/// sigma = sqrt((initial^2 + sum of e^2) / (1 + n)) over the n scans whose model error e exceeded
/// min_motion.
class AdaptiveThreshold {
 public:
  /// All in metres and positive: sigma before any scan; errors below min_motion do not count;
  /// max_range turns a rotation into the displacement of the farthest point.
  AdaptiveThreshold(double initial, double min_motion, double max_range);

  double sigma() const;  ///< m

  /// Takes prediction^-1 * estimate of one scan. e = |translation| + 2 max_range sin(angle / 2).
  void observe(const Rigid3& predicted_from_estimated);

 private:
  double min_motion_;
  double max_range_;
  double sum_of_squares_;
  double samples_ = 1.0;
};

}  // namespace kissmap
