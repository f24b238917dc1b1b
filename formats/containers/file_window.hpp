// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/containers/container_file.hpp"

namespace kissmap {

/// A file read from front to back, piece by piece. Memory: 1 MiB, or the largest piece asked for.
/// Not thread safe.
class FileWindow {
 public:
  /// The file has to outlive the window.
  explicit FileWindow(const ContainerFile& file) : file_(file) {}

  /// `count` bytes from `offset` on, fewer where the file ends; valid until the next call. Throws
  /// Error(input) when the file cannot be read.
  std::span<const std::byte> at(std::uint64_t offset, std::uint64_t count);

 private:
  const ContainerFile& file_;
  std::vector<std::byte> bytes_;
  std::uint64_t offset_ = 0;
  std::size_t size_ = 0;
};

}  // namespace kissmap
