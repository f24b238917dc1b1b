// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

namespace kissmap {

// Names inside a session folder, see FORMAT.md.
inline constexpr const char* manifest_file_name = "session.json";
inline constexpr const char* configuration_file_name = "config.toml";
inline constexpr const char* scans_file_name = "scans.csv";
inline constexpr const char* local_maps_file_name = "local_maps.csv";
inline constexpr const char* local_maps_folder_name = "local_maps";
inline constexpr const char* keyposes_file_name = "keyposes.csv";
inline constexpr const char* poses_file_name = "poses.csv";
inline constexpr const char* closures_file_name = "closures.csv";
inline constexpr const char* neighbors_file_name = "neighbors.csv";
inline constexpr const char* surfaces_file_name = "surfaces.csv";
inline constexpr const char* graph_file_name = "pose_graph.g2o";
inline constexpr const char* tum_file_name = "trajectory.tum";
inline constexpr const char* kitti_file_name = "trajectory_kitti.txt";
inline constexpr const char* picture_file_name = "map.png";
inline constexpr const char* edits_file_name = "edits.txt";
/// Files that follow from evidence and edits; a session has those that were written for it.
inline constexpr std::array derived_file_names = {edits_file_name,
                                                  keyposes_file_name,
                                                  poses_file_name,
                                                  closures_file_name,
                                                  neighbors_file_name,
                                                  surfaces_file_name,
                                                  graph_file_name,
                                                  tum_file_name,
                                                  kitti_file_name,
                                                  picture_file_name};
/// Folder in which `kissmap optimize` gets ready what it will put in place.
inline constexpr const char* staging_folder_name = "optimize.partial";
/// Folder of the default products, and the one in which they are got ready.
inline constexpr const char* products_folder_name = "products";
inline constexpr const char* products_staging_name = "products.partial";

/// Ends the message about a session that is damaged.
inline constexpr const char* damaged_session_cure =
    "restore the session from a copy or make it again with 'kissmap run'";

std::filesystem::path local_map_file(const std::filesystem::path& session, std::uint32_t id);

/// The path without a trailing separator, so that names can be appended to it.
std::filesystem::path folder_path(const std::filesystem::path& path);

/// First entry of a folder that no session has, or that is of the wrong kind; empty if there is
/// none. Guards whatever a user keeps beside or inside a session against deletion.
std::string first_foreign_name(const std::filesystem::path& folder);

/// Held while a session is being written or changed, so that nothing else does the same.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  bool take() const;     ///< false if another process has it
  void require() const;  ///< throws Error(output) if another process has it

 private:
  std::filesystem::path folder_;
  int descriptor_;
};

/// Where a session that is being overwritten waits until its successor is in place.
std::filesystem::path replaced_path(const std::filesystem::path& session);

/// Throws Error(output) unless a session may be written to `path`.
void require_writable_target(const std::filesystem::path& path, bool overwrite);

/// Creates an empty folder, replacing a stale one that holds session files only.
/// Throws Error(output).
void create_partial_folder(const std::filesystem::path& partial);

/// Gives a complete folder its name. With `overwrite`, a session of that name is moved away first
/// and deleted when its successor is in place. Throws Error(output).
void publish_folder(const std::filesystem::path& partial,
                    const std::filesystem::path& path,
                    bool overwrite);

}  // namespace kissmap
