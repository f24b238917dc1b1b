// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Quantisation step of packed coordinates [m]; a point moves by at most half of it per axis.
inline constexpr double pack_resolution = 0.002;

/// Name of the pack inside a session.
inline constexpr const char* pack_file_name = "packed_log.kmpack";

/// Stores scans in one file: coordinates in steps of pack_resolution, time offsets to 1 ns,
/// intensities unchanged, no-return directions to 1e-4 rad; compressed scan by scan.
/// Layout: formats/session/FORMAT.md. Throws Error(output).
class PackWriter {
 public:
  explicit PackWriter(const std::filesystem::path& path);
  ~PackWriter();
  void add(const LogEntry& entry);  ///< a refused scan is stored with its reason
  void finish();                    ///< writes the end mark and flushes to disk
  std::uint64_t bytes() const;
  std::uint64_t points() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kissmap
