// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>

#include "formats/files/output_file.hpp"

namespace kissmap {

/// A file written aside whose beginning is known last. It appears whole or not at all: without
/// publish() nothing stays. Each member throws Error(output) naming the file.
class AsideFile {
 public:
  explicit AsideFile(const std::filesystem::path& path);
  ~AsideFile();
  AsideFile(const AsideFile&) = delete;
  AsideFile& operator=(const AsideFile&) = delete;

  void write(std::string_view bytes) { file_.write(bytes); }

  /// Puts `beginning` over the first bytes, flushes all to the disk and gives the file its name.
  void publish(std::string_view beginning);

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  OutputFile file_;
  bool published_ = false;
};

}  // namespace kissmap
