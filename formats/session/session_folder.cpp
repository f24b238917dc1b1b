// SPDX-License-Identifier: MIT
#include "formats/session/session_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "formats/files/output_file.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/session.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

constexpr std::array measured_file_names = {manifest_file_name,
                                            configuration_file_name,
                                            scans_file_name,
                                            local_maps_file_name,
                                            pack_file_name};

bool is_file_name(std::string_view name) {
  const auto same = [name](const char* known) { return name == known; };
  return std::ranges::any_of(measured_file_names, same) ||
         std::ranges::any_of(derived_file_names, same);
}

fs::file_type type_of(const fs::path& path) {
  std::error_code code;
  return fs::symlink_status(path, code).type();
}

bool is_there(const fs::path& path) {
  return type_of(path) != fs::file_type::not_found;
}

// A file still being written, or stopped while it was, carries ".partial".
std::string_view without_partial(std::string_view name) {
  constexpr std::string_view ending = ".partial";
  return name.ends_with(ending) ? name.substr(0, name.size() - ending.size()) : name;
}

bool is_session_file(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  return entry.symlink_status().type() == fs::file_type::regular &&
         is_file_name(without_partial(name));
}

bool is_local_map_file(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  const std::string_view base = without_partial(name);
  const std::string_view digits =
      base.substr(0, base.size() - std::min<std::size_t>(4, base.size()));
  return entry.symlink_status().type() == fs::file_type::regular && base.ends_with(".ply") &&
         digits.size() >= 6 && digits.find_first_not_of("0123456789") == std::string_view::npos;
}

bool is_product_file(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  const auto begins = [&name](const char* known) { return name.starts_with(known); };
  return entry.symlink_status().type() == fs::file_type::regular &&
         std::ranges::any_of(std::array{"cloud.", "voxels.", "grid.", "grid_"}, begins);
}

bool is_inner_folder(const fs::directory_entry& entry) {
  const fs::path name = entry.path().filename();
  const auto same = [&name](const char* known) { return name == known; };
  return entry.symlink_status().type() == fs::file_type::directory &&
         std::ranges::any_of(std::array{local_maps_folder_name,
                                        staging_folder_name,
                                        products_folder_name,
                                        products_staging_name},
                             same);
}

template <typename Known>
std::string first_not(const Known& known, const fs::path& folder) {
  if (!is_there(folder)) return {};
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!known(entry)) return entry.path().filename().string();
  }
  return {};
}

std::string find_foreign_name(const fs::path& folder) {
  const auto known = [](const fs::directory_entry& entry) {
    return is_session_file(entry) || is_inner_folder(entry);
  };
  if (std::string name = first_not(known, folder); !name.empty()) return name;
  const std::string map = first_not(is_local_map_file, folder / local_maps_folder_name);
  if (!map.empty()) return (fs::path(local_maps_folder_name) / map).string();
  for (const char* products : {products_folder_name, products_staging_name}) {
    const std::string file = first_not(is_product_file, folder / products);
    if (!file.empty()) return (fs::path(products) / file).string();
  }
  if (!is_there(folder / staging_folder_name)) return {};
  std::string staged = find_foreign_name(folder / staging_folder_name);
  return staged.empty() ? staged : (fs::path(staging_folder_name) / staged).string();
}

void remove_folder(const fs::path& folder) {
  std::error_code code;
  fs::remove_all(folder, code);
  if (code) throw output_error(folder, "cannot be removed: " + code.message());
}

void require_only_session_files(const fs::path& folder) {
  const std::string foreign = first_foreign_name(folder);
  if (!foreign.empty()) {
    throw output_error(folder,
                       "not overwritten, because '" + foreign +
                           "' in it is not part of a session; move it away first");
  }
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder)
    : folder_(folder), descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool FolderLock::take() const {
  return descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

void FolderLock::require() const {
  if (take()) return;
  throw output_error(folder_,
                     "is being written by another run; wait for it or choose another name");
}

fs::path local_map_file(const fs::path& session, std::uint32_t id) {
  std::string name = std::to_string(id);
  if (name.size() < 6) name.insert(0, 6 - name.size(), '0');
  return session / local_maps_folder_name / (name + ".ply");
}

fs::path folder_path(const fs::path& path) {
  const fs::path normal = path.lexically_normal();
  return normal.has_filename() || !normal.has_relative_path() ? normal : normal.parent_path();
}

std::string first_foreign_name(const fs::path& folder) try {
  return find_foreign_name(folder);
} catch (const fs::filesystem_error& error) {
  throw output_error(folder, std::string("cannot be listed: ") + error.code().message());
}

fs::path replaced_path(const fs::path& session) {
  fs::path path = session;
  path += ".replaced";
  return path;
}

void require_writable_target(const fs::path& path, bool overwrite) {
  if (!path.has_filename() || path.filename() == "." || path.filename() == "..") {
    throw output_error(path, "is no name for a new session; give the path of a new folder");
  }
  if (is_there(replaced_path(path))) {
    throw output_error(replaced_path(path),
                       "is left from an interrupted overwrite; rename or remove it first");
  }
  if (!is_there(path)) return;
  if (!overwrite) {
    throw output_error(path, "exists already; choose another name, or --overwrite a session");
  }
  if (type_of(path) != fs::file_type::directory || !is_session(path)) {
    throw output_error(path, "is not a session folder and is not overwritten; choose another name");
  }
  require_only_session_files(path);
}

void create_partial_folder(const fs::path& partial) {
  if (is_there(partial)) {
    if (type_of(partial) != fs::file_type::directory) {
      throw output_error(partial, "is in the way and not a folder of ours; move it away first");
    }
    require_only_session_files(partial);
    remove_folder(partial);
  }
  std::error_code code;
  fs::create_directory(partial, code);
  if (!code) fs::create_directory(partial / local_maps_folder_name, code);
  if (code) {
    throw output_error(
        partial,
        "cannot be created: " + code.message() + "; choose an existing folder you may write to");
  }
}

void publish_folder(const fs::path& partial, const fs::path& path, bool overwrite) {
  require_writable_target(path, overwrite);
  const fs::path replaced = replaced_path(path);
  const bool replaces = is_there(path);
  if (replaces) rename_path(path, replaced);
  try {
    rename_path(partial, path);
  } catch (const Error&) {
    if (replaces) rename_path(replaced, path);
    throw;
  }
  sync_folder(path.parent_path());
  if (replaces) remove_folder(replaced);
}

}  // namespace kissmap
