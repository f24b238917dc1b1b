// SPDX-License-Identifier: MIT
#include "kissmap/evaluation/evaluation.hpp"

#include <utility>

#include "kissmap/error.hpp"
#include "kissmap/evaluation/trajectory.hpp"

namespace kissmap {
namespace {

Rigid3 require_alignment(const PosePairs& pairs, MapAlignment alignment) {
  if (pairs.positions_only && alignment == MapAlignment::first) {
    throw Error(
        Fault::input,
        "only positions are known: the first pose cannot be aligned by; align by se3 or yaw");
  }
  if (const auto found = align(pairs.reference, pairs.estimate, alignment)) return *found;
  throw Error(Fault::input,
              "the " + std::to_string(pairs.size()) +
                  " positions compared do not fix a rotation (too few, or all on one line); align "
                  "by the first pose instead");
}

RelativeError relative_error_of(const PosePairs& pairs, const Delta& delta, PairChoice choice) {
  const bool no_stamps = delta.unit == DeltaUnit::seconds && pairs.stamps_ns.empty();
  if (no_stamps || pairs.positions_only) return {delta, {}, {}};
  const PoseErrors errors =
      relative_error(pairs.reference,
                     pairs.estimate,
                     choose_pairs(pairs.estimate, pairs.stamps_ns, delta, choice));
  return {delta, statistics(errors.translation), statistics(errors.rotation)};
}

}  // namespace

void require_valid(const EvaluationOptions& options) {
  require_valid(options.association);
  for (const Delta& delta : options.deltas) require_valid(delta);
  require_valid(options.kitti);
}

Evaluation evaluate(PosePairs pairs, const EvaluationOptions& options) {
  require_valid(options);
  Evaluation result;
  result.pairs = std::move(pairs);
  const PosePairs& matched = result.pairs;
  result.reference_from_map = require_alignment(matched, options.alignment);
  result.distances = distances_along(matched.reference);
  result.absolute =
      absolute_error(matched.reference, transformed(result.reference_from_map, matched.estimate));
  result.absolute_translation = statistics(result.absolute.translation);
  if (matched.positions_only) result.absolute.rotation.clear();
  result.absolute_rotation = statistics(result.absolute.rotation);
  for (const Delta& delta : options.deltas) {
    result.relative.push_back(relative_error_of(matched, delta, options.pairs));
  }
  if (!matched.positions_only) {
    result.kitti = kitti_error(matched.reference, matched.estimate, options.kitti);
  }
  return result;
}

}  // namespace kissmap
