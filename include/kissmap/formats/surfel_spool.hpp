// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "kissmap/mapping/local_map.hpp"

namespace kissmap {

/// Surfels put aside on the disk until the end of a run, so that memory does not grow with the
/// log. The file has no name: it is gone when the spool is, however the program ends. 24 bytes a
/// surfel. add() excludes read(); read() may be called from several threads.
class SurfelSpool {
 public:
  /// In a folder that can be written to. Throws Error(output).
  explicit SurfelSpool(const std::filesystem::path& folder);
  ~SurfelSpool();
  SurfelSpool(const SurfelSpool&) = delete;
  SurfelSpool& operator=(const SurfelSpool&) = delete;

  void add(const SurfelCloud& surfels);       ///< throws Error(output), as on a full disk
  SurfelCloud read(std::size_t index) const;  ///< in the order of add(); throws Error(input)

  std::size_t size() const { return begins_.size() - 1; }

 private:
  std::filesystem::path folder_;
  int descriptor_ = -1;
  std::vector<std::uint64_t> begins_{0};  ///< surfels before each cloud, and all
};

}  // namespace kissmap
