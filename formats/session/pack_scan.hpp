// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "formats/session/pack_bytes.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

// The inner layout of a pack: one entry of a log as bytes, before compression. See FORMAT.md.

/// A coordinate or a time as it comes back from a pack is a function of what was stored only, so
/// that packing twice changes nothing more.
/// Throws Error(internal) for an inconsistent scan or directions that are not of unit length.
std::string encode_scan(const std::string& name, const Scan& scan);
std::string encode_refusal(const std::string& name, const RefusedScan& refusal);

/// `index` is left at 0. Throws DamagedPack.
LogEntry decode_scan(std::string_view bytes);
LogEntry decode_refusal(std::string_view bytes);

}  // namespace kissmap
