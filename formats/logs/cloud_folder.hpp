// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/clouds/cloud_file.hpp"
#include "formats/logs/folder_log.hpp"

namespace kissmap {

/// Where the clouds of a log lie: in its folder or in a subfolder.
struct CloudFolder {
  std::filesystem::path root;
  std::filesystem::path clouds;
  std::string prefix;  ///< of the names, relative to the root: "" or "scans/"
};

/// The folder itself if it holds .pcd, .ply or .bin files, else those of its subfolders that do.
std::vector<CloudFolder> find_cloud_folders(const std::filesystem::path& root);

/// Throws Error(input) unless there is exactly one.
CloudFolder the_cloud_folder(const std::filesystem::path& root);

/// The clouds of a folder in natural order, all of one kind. Throws Error(input) listing the kinds
/// if they are mixed, be it with kinds that kissmap does not read.
std::vector<ScanFile> list_clouds(const CloudFolder& folder);

/// Gives each scan its stamp and says where from: names, then times.txt or timestamps.txt in
/// either folder, then the position in the log. Sorts by the stamps in names.
/// Throws Error(input) when only some names are stamps, or a file has more or fewer stamps than
/// there are scans.
void find_stamps(const CloudFolder& folder, FolderContent& content);

/// The same for one file on its own.
void find_stamp_of_single_file(FolderContent& content);

}  // namespace kissmap
