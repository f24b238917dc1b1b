// SPDX-License-Identifier: MIT
#include "kissmap/formats/product_folder.hpp"

#include <optional>
#include <string>
#include <system_error>

#include "formats/files/output_file.hpp"
#include "formats/session/session_folder.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

void require_no_foreign_files(const fs::path& session) {
  const std::string foreign = first_foreign_name(session);
  if (!foreign.starts_with(products_folder_name)) return;
  throw output_error(session / foreign,
                     "is none of ours and would be lost with the products; move it away first");
}

bool remove_folder(const fs::path& folder) {
  std::error_code code;
  const bool there = fs::remove_all(folder, code) > 0;
  if (code) throw output_error(folder, "cannot be removed: " + code.message());
  return there;
}

}  // namespace

class ProductFolder::Impl {
 public:
  explicit Impl(const fs::path& session)
      : path(session / products_staging_name), final_path(session / products_folder_name) {
    require_no_foreign_files(session);
    FolderLock(path).require();
    remove_folder(path);
    std::error_code code;
    if (!fs::create_directory(path, code)) {
      throw output_error(path, "cannot be created: " + code.message());
    }
    lock.emplace(path);
    lock->require();
  }

  ~Impl() {
    if (published) return;
    std::error_code ignored;  // replaced by the next one
    fs::remove_all(path, ignored);
  }

  fs::path path;
  fs::path final_path;
  std::optional<FolderLock> lock;
  bool published = false;
};

ProductFolder::ProductFolder(const fs::path& session)
    : impl_(std::make_unique<Impl>(folder_path(session))) {
}

ProductFolder::~ProductFolder() = default;

const fs::path& ProductFolder::path() const {
  return impl_->path;
}

fs::path ProductFolder::publish() {
  sync_folder(impl_->path);
  remove_folder(impl_->final_path);
  rename_path(impl_->path, impl_->final_path);
  impl_->published = true;
  sync_folder(impl_->final_path.parent_path());
  return impl_->final_path;
}

bool remove_products(const fs::path& session) {
  const fs::path folder = folder_path(session);
  require_no_foreign_files(folder);
  remove_folder(folder / products_staging_name);
  return remove_folder(folder / products_folder_name);
}

}  // namespace kissmap
