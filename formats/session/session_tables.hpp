// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "kissmap/formats/session.hpp"

namespace kissmap {

// scans.csv and local_maps.csv of a session, finished or not; columns in FORMAT.md.
// Reading throws Error(input) naming file, line, column and cure.

std::string scans_header();
std::string local_maps_header();

/// One line with its end. Throws Error(internal) for poses that are not rigid.
std::string scan_row(const SessionScan& scan);
std::string local_map_row(const LocalMap& local_map);

/// Keeps the stamp of the first pose in each local map, by id. Scans must come in their order; a
/// local map without scans gets the stamp of the next one.
void note_first_stamp(const MappedScan& scan, std::vector<std::int64_t>& stamps_ns);

/// All local maps, where odometry put them, without their surfels; ids count from 0.
std::vector<LocalMap> read_odometry_local_maps(const std::filesystem::path& session);

/// The same where the corrected keyposes put them, if there are any.
std::vector<LocalMap> read_local_maps(const std::filesystem::path& session);

/// Calls `visit` with each scan in recorded order; `local_maps` place them in the map frame.
/// Scans of a local map that was never closed are passed over in an unfinished session and an
/// error in a finished one.
enum class UnclosedScans { pass_over, refuse };
void for_each_scan(const std::filesystem::path& session,
                   const std::vector<LocalMap>& local_maps,
                   UnclosedScans unclosed,
                   const std::function<void(const SessionScan&)>& visit);

}  // namespace kissmap
