// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "formats/containers/message_source.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// The scans of one topic of a container. `info` brings format and path, the rest is filled in.
/// Damage of the container is an entry of its own at the end, a RefusedScan. Throws Error(usage)
/// for a topic the container does not have, Error(input) where there is none or more than one to
/// choose from, naming them.
std::unique_ptr<ScanLog> open_message_log(std::unique_ptr<MessageSource> source,
                                          LogInfo info,
                                          const ReadOptions& options);

}  // namespace kissmap
