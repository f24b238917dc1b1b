// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace kissmap {

/// A folder written aside as PATH.partial; gone unless it is published. Throws Error(output).
class AsideFolder {
 public:
  /// Nothing may be at `path`; what an earlier attempt left aside is removed.
  explicit AsideFolder(const std::filesystem::path& path);
  ~AsideFolder();
  AsideFolder(const AsideFolder&) = delete;
  AsideFolder& operator=(const AsideFolder&) = delete;

  const std::filesystem::path& path() const { return aside_; }
  void publish();

 private:
  std::filesystem::path path_;
  std::filesystem::path aside_;
};

/// Throws Error(output) if something is at `path`.
void require_free(const std::filesystem::path& path);

/// "000012"
std::string six_digits(std::uint64_t number);

}  // namespace kissmap
