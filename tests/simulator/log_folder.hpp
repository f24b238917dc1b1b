// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>

#include "simulator/simulator.hpp"

namespace kissmap::simulator {

/// Writes FOLDER/scans/<seconds>_<nanoseconds, 9 digits>.ply (binary little endian PLY: x, y, z,
/// intensity, time [s after the stamp]; the stamp is the start of the sweep; returns only) and
/// FOLDER/truth.tum (map_from_lidar at the end of each sweep). With `labels` also
/// FOLDER/labels/<name of the scan>.u8, one byte a point: the number of its ObjectClass; and
/// FOLDER/labels/classes.csv, which lists number, name and whether the class moves (1 or 0). The
/// folder appears whole or not at all: it is written as FOLDER.partial and renamed. The same bytes
/// for any number of threads. Of the scans the first is written and each `every`th after it.
/// `progress(done)` is called after each batch of scans. Throws Error(output) where the folder
/// exists or cannot be written.
void write_log_folder(const Simulator& simulator,
                      const std::filesystem::path& folder,
                      int threads,
                      const std::function<void(std::size_t done)>& progress,
                      bool labels = false,
                      std::size_t every = 1);

}  // namespace kissmap::simulator
