// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Where a log tells its place on earth, each in some words: topics of satellite fixes in bags and
/// captures, files that data sets keep them in, the coordinate system of LAS files. Empty where
/// none is known. `first_scan` is the name of the log's first entry, one file of a folder.
/// Never throws for what cannot be read.
std::vector<std::string> find_georeference(const LogInfo& about, const std::string& first_scan);

}  // namespace kissmap
