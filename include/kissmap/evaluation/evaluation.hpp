// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "kissmap/evaluation/alignment.hpp"
#include "kissmap/evaluation/association.hpp"
#include "kissmap/evaluation/kitti_error.hpp"
#include "kissmap/evaluation/pose_error.hpp"

namespace kissmap {

struct EvaluationOptions {
  AssociationOptions association;
  MapAlignment alignment = MapAlignment::se3;
  /// Of the relative errors. Those in seconds are passed over where there are no stamps.
  std::vector<Delta> deltas = {
      {1.0, DeltaUnit::frames}, {1.0, DeltaUnit::seconds}, {10.0, DeltaUnit::metres}};
  PairChoice pairs = PairChoice::consecutive;
  KittiOptions kitti;
};
/// Throws Error(usage) naming the option.
void require_valid(const EvaluationOptions& options);

struct RelativeError {
  Delta delta;
  ErrorStatistics translation;  ///< m; count 0 where no two poses are that far apart
  ErrorStatistics rotation;     ///< rad
};

/// How far an estimate is from a reference.
struct Evaluation {
  PosePairs pairs;                       ///< what was compared, before alignment
  Rigid3 reference_from_map;             ///< the alignment
  std::vector<double> distances;         ///< m, along the reference, of each pair
  PoseErrors absolute;                   ///< after alignment, of each pair
  ErrorStatistics absolute_translation;  ///< m
  ErrorStatistics absolute_rotation;     ///< rad
  std::vector<RelativeError> relative;   ///< one for each delta
  KittiError kitti;
};

/// Judges poses that belong together. Relative pairs are chosen on the estimate (as evo does),
/// segments of the KITTI error on the reference. Where only positions are known, the absolute error
/// of translation is all there is. Throws Error(input) where the alignment is not
/// defined.
Evaluation evaluate(PosePairs pairs, const EvaluationOptions& options = {});

}  // namespace kissmap
