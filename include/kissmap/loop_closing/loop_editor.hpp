// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "kissmap/loop_closing/closure_validation.hpp"
#include "kissmap/loop_closing/loop_correction.hpp"

namespace kissmap {

/// Changes the closures of a map by hand. What comes of it depends on the evidence and the edits in
/// their order, and on nothing else. The two ids of an edit may come in either order; of poses,
/// `to` is seen from `from`. Edits that cannot be made throw Error(input) and change nothing.
/// Not thread safe.
class LoopEditor {
 public:
  /// Gives the surfels of a local map; asked for by add() and join() only.
  using SurfelSource = std::function<SurfelCloud(std::uint32_t id)>;

  /// `evidence` without edits; `voxel_size` [m] is that of the local maps' grids.
  LoopEditor(LoopEvidence evidence,
             std::vector<ScanPlace> scans,
             const ClosureValidationOptions& validation,
             double voxel_size,
             SurfelSource surfels);

  /// Drops the closure between the two: one that was measured is marked, one that was added is
  /// gone, and one that was fixed against its figures is refused again.
  void remove(std::uint32_t from, std::uint32_t to);

  /// Believes the closure between the two whatever others say. Without one, takes the refused
  /// candidate that overlaps most, with the pose that was measured for it.
  void fix(std::uint32_t from, std::uint32_t to);

  /// Adds a closure with this pose as it is. It may contradict others and be refused.
  void add(std::uint32_t from,
           std::uint32_t to,
           const Rigid3& from_from_to,
           const ClosureSigmas& sigmas);

  /// Registers the two local maps, from a guess or else from where the edits so far place them, and
  /// adds what was found; the same checks as for candidates, but for the drift. A guess that leads
  /// nowhere is tried again with offsets of up to 6 m, odometry's drift over some hundred metres.
  void join(std::uint32_t from,
            std::uint32_t to,
            const std::optional<Rigid3>& guess_from_from_to = {});

  /// What correct_loops() makes of the edits so far.
  const LoopCorrection& correction();

 private:
  struct Pair {
    std::uint32_t query = 0;
    std::uint32_t reference = 0;
  };
  Pair pair_of(std::uint32_t from, std::uint32_t to) const;
  Pair open_pair(std::uint32_t from, std::uint32_t to) const;
  std::vector<std::size_t> find(const Pair& pair, bool in_graph) const;
  void append(const Pair& pair, Closure closure);
  SurfelReference reference_of(const Pair& pair) const;

  LoopEvidence evidence_;
  std::vector<ScanPlace> scans_;
  ClosureValidationOptions validation_;
  double voxel_size_;
  SurfelSource surfels_;
  std::optional<LoopCorrection> correction_;
};

}  // namespace kissmap
