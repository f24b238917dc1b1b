// SPDX-License-Identifier: MIT
#include "formats/files/aside_file.hpp"

#include <system_error>

namespace kissmap {

AsideFile::AsideFile(const std::filesystem::path& path) : path_(path), file_(aside(path)) {
}

AsideFile::~AsideFile() {
  std::error_code ignored;  // whoever left early has said why
  if (!published_) std::filesystem::remove(file_.path(), ignored);
}

void AsideFile::publish(std::string_view beginning) {
  file_.rewrite_beginning(beginning);
  file_.close();
  rename_path(file_.path(), path_);
  published_ = true;
  sync_folder(path_.parent_path());
}

}  // namespace kissmap
