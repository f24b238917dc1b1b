// SPDX-License-Identifier: MIT
#include "formats/conversion/scan_folder.hpp"

#include <cstdio>
#include <system_error>

#include "formats/files/output_file.hpp"
#include "kissmap/error.hpp"

namespace kissmap {

namespace fs = std::filesystem;

void require_free(const fs::path& path) {
  std::error_code code;
  if (fs::exists(fs::symlink_status(path, code))) {
    throw output_error(path, "exists already; choose another name");
  }
}

AsideFolder::AsideFolder(const fs::path& path)
    : path_(path.has_filename() ? path : path.parent_path()), aside_(aside(path_)) {
  require_free(path_);
  std::error_code code;
  fs::remove_all(aside_, code);
  if (!fs::create_directories(aside_, code)) {
    throw output_error(aside_, "cannot be created: " + code.message() + "; choose another place");
  }
}

AsideFolder::~AsideFolder() {
  std::error_code ignored;
  fs::remove_all(aside_, ignored);
}

void AsideFolder::publish() {
  sync_folder(aside_);
  rename_path(aside_, path_);
  sync_folder(fs::absolute(path_).parent_path());
}

std::string six_digits(std::uint64_t number) {
  char text[24];
  std::snprintf(text, sizeof(text), "%06llu", static_cast<unsigned long long>(number));
  return text;
}

}  // namespace kissmap
