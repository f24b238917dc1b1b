// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// A file read here and there. Not thread safe.
class ContainerFile {
 public:
  /// Throws Error(input).
  explicit ContainerFile(const std::filesystem::path& path);
  ~ContainerFile();
  ContainerFile(const ContainerFile&) = delete;
  ContainerFile& operator=(const ContainerFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }
  LogFile log_file() const;

  /// `count` bytes from `offset` on, into `buffer`, whose memory is reused; fewer where the file
  /// ends. Throws Error(input) when the file cannot be read.
  std::span<const std::byte> read(std::uint64_t offset,
                                  std::uint64_t count,
                                  std::vector<std::byte>& buffer) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace kissmap
