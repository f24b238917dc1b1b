// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Readers of public data sets; their promises are those of LogFormat. Each names in its .cpp where
/// its layout was learnt.
bool probe_mulran(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_mulran(const std::filesystem::path& path, const ReadOptions& options);

bool probe_helipr(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_helipr(const std::filesystem::path& path, const ReadOptions& options);

bool probe_apollo(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_apollo(const std::filesystem::path& path, const ReadOptions& options);

bool probe_nclt(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_nclt(const std::filesystem::path& path, const ReadOptions& options);

bool probe_nclt_hits(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_nclt_hits(const std::filesystem::path& path,
                                        const ReadOptions& options);

bool probe_newer_college(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_newer_college(const std::filesystem::path& path,
                                            const ReadOptions& options);

bool probe_boreas(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_boreas(const std::filesystem::path& path, const ReadOptions& options);

bool probe_paris_luco(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_paris_luco(const std::filesystem::path& path,
                                         const ReadOptions& options);

bool probe_nuscenes(const std::filesystem::path& path);
std::unique_ptr<ScanLog> open_nuscenes(const std::filesystem::path& path,
                                       const ReadOptions& options);

/// True if one of the above agrees.
bool probe_any_dataset(const std::filesystem::path& path);

}  // namespace kissmap
