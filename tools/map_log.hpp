// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/session.hpp"
#include "kissmap/graph/trajectory_spread.hpp"
#include "kissmap/loop_closing/loop_closer.hpp"
#include "kissmap/mapping/mapper.hpp"
#include "progress.hpp"
#include "stretch_recorder.hpp"

namespace kissmap {

/// What a run learned beyond the rows it wrote.
struct MappedLog {
  SessionCounts counts;
  double path_length = 0.0;  ///< m
  double log_seconds = 0.0;  ///< s from the first used scan to the last; 0 without stamps
  std::uint32_t local_maps = 0;
  std::vector<ScanPlace> places;  ///< of the scans used
};

/// What takes in the scans and local maps of a run as they come. Loops and stretches do so on a
/// thread of their own; nothing they find reaches back into odometry.
struct RunOutputs {
  SessionWriter& session;
  LoopCloser& loops;
  StretchRecorder* stretches = nullptr;  ///< none where loops are left open
  PackWriter* pack = nullptr;            ///< takes every entry of the log, if there is one
};

/// Feeds a log through the mapper and into the outputs. Throws Error(input), and writes no local
/// map, when not a single scan could be used.
MappedLog map_log(ScanLog& log,
                  Mapper& mapper,
                  const RunOutputs& outputs,
                  const std::function<void(const RunProgress&)>& progress);

}  // namespace kissmap
