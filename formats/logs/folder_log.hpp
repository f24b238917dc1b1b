// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// A file that holds one scan.
struct ScanFile {
  std::filesystem::path path;
  std::string name;  ///< relative to the log's folder
  std::uint64_t size_bytes = 0;
  std::optional<std::int64_t> stamp_ns;  ///< none: the scan is refused
};

/// What makes one folder of scans differ from another.
struct FolderContent {
  LogInfo info;
  std::vector<ScanFile> scans;      ///< in recorded order
  bool stamps_are_indices = false;  ///< see Scan::stamp_is_index
  std::vector<LogFile> side_files;  ///< stamps, calibration: read when the log was opened
  /// Bytes of a file -> scan with stamp and all. Throws Refusal.
  std::function<Scan(std::span<const std::byte> bytes, std::size_t index)> decode;
};

/// A log that is a list of files with one scan each.
class FolderLog : public ScanLog {
 public:
  explicit FolderLog(FolderContent content);

  const LogInfo& info() const override { return content_.info; }
  std::optional<LogEntry> next() override;
  void skip(std::size_t count) override;
  std::optional<std::vector<std::int64_t>> known_times() override;
  std::vector<LogFile> files() const override;

  /// The entry next() will give, read already: for notes that need a look at the first scan.
  /// Nothing at the end.
  const LogEntry* peek();
  void add_note(const std::string& note) { content_.info.notes.push_back(note); }
  void set_fields(const std::string& fields) { content_.info.fields = fields; }

 private:
  LogEntry read(std::size_t index);

  FolderContent content_;
  std::vector<std::string> hashes_;
  std::vector<std::byte> buffer_;
  std::optional<LogEntry> peeked_;
  std::size_t next_index_ = 0;
};

/// Files of a folder whose name `accept`s, hidden ones left out, in natural order of their names.
/// `prefix` is put before the names. Throws Error(input) when the folder cannot be listed.
std::vector<ScanFile> list_files(const std::filesystem::path& folder,
                                 const std::string& prefix,
                                 const std::function<bool(const std::filesystem::path&)>& accept);

}  // namespace kissmap
