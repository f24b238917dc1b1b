// SPDX-License-Identifier: MIT
#include "formats/logs/cloud_folder.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <system_error>

#include "formats/text/stamps.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

bool is_cloud(const fs::path& path) {
  return kind_by_name(path).has_value();
}

bool has_clouds(const fs::path& folder) {
  const auto clouds = [](const fs::directory_entry& entry) {
    return !entry.path().filename().string().starts_with('.') && is_cloud(entry.path()) &&
           !entry.is_directory();
  };
  std::error_code error;
  const fs::directory_iterator entries(folder, error);
  return !error && std::any_of(begin(entries), end(entries), clouds);
}

// Files that hold clouds too, but in a way kissmap does not read: worth a word, not silence.
bool is_foreign_cloud(const fs::path& path) {
  const std::string extension = path.extension().string();
  constexpr const char* foreign[] = {".laz"};
  return std::ranges::find(foreign, extension) != std::end(foreign);
}

void require_one_kind(const CloudFolder& folder, const std::vector<ScanFile>& scans) {
  std::map<std::string, std::size_t> counts;
  for (const ScanFile& scan : scans) ++counts[scan.path.extension().string()];
  const auto kind = kind_by_name(scans[0].path);
  const bool same = std::ranges::all_of(
      scans, [&](const ScanFile& scan) { return kind_by_name(scan.path) == kind; });
  if (kind && same) return;
  std::string list;
  for (const auto& [extension, count] : counts) {
    list += (list.empty() ? "" : ", ") + std::to_string(count) + " " + extension;
  }
  throw input_error(folder.clouds, "files of several kinds: " + list + "; move all but one away");
}

}  // namespace

std::vector<CloudFolder> find_cloud_folders(const fs::path& root) {
  if (has_clouds(root)) return {{root, root, ""}};
  std::vector<CloudFolder> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(root, error)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && !name.starts_with('.') && has_clouds(entry.path())) {
      found.push_back({root, entry.path(), name + "/"});
    }
  }
  std::ranges::sort(found, natural_less, &CloudFolder::prefix);
  return found;
}

CloudFolder the_cloud_folder(const fs::path& root) {
  const std::vector<CloudFolder> found = find_cloud_folders(root);
  if (found.size() == 1) return found[0];
  if (found.empty())
    throw input_error(root, "no .pcd, .ply, .bin, .npy, .xyz, .csv or .las file in it");
  std::string names;
  for (const CloudFolder& folder : found) names += " " + folder.prefix;
  throw input_error(root, "several folders hold clouds:" + names + "; name one of them");
}

std::vector<ScanFile> list_clouds(const CloudFolder& folder) {
  const auto accept = [](const fs::path& path) { return is_cloud(path) || is_foreign_cloud(path); };
  std::vector<ScanFile> scans = list_files(folder.clouds, folder.prefix, accept);
  if (scans.empty())
    throw input_error(folder.clouds, "no .pcd, .ply, .bin, .npy, .xyz, .csv or .las file in it");
  require_one_kind(folder, scans);
  return scans;
}

}  // namespace kissmap
