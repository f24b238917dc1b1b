// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kissmap {

/// A file being written, every call checked. Each member throws Error(output) naming the file.
/// Not thread safe.
class OutputFile {
 public:
  /// Creates the file or empties the one that is there.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();  ///< closes without a promise; call close() first
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);              ///< may stay in memory until flush()
  void rewrite_beginning(std::string_view bytes);  ///< flushes; no more bytes than were written
  void flush();  ///< hands all to the system: survives the end of the process
  void close();  ///< flushes to the disk: survives a power cut

  std::uint64_t bytes() const { return bytes_; }  ///< written so far
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::string buffer_;
  std::uint64_t bytes_ = 0;
};

/// `path` with ".partial" appended: where a file is written until it is complete.
std::filesystem::path aside(const std::filesystem::path& path);

/// Writes a whole file aside, flushes it to the disk and gives it its name. Throws Error(output)
/// and leaves nothing aside then.
void write_whole_file(const std::filesystem::path& path, std::string_view bytes);

struct WholeFile {
  std::filesystem::path path;
  std::string bytes;
};

/// The same for the files of one result: all are written aside before the first gets its name, so
/// that where the disk fills up none is new beside an old one.
void write_whole_files(const std::vector<WholeFile>& files);

/// Makes created, renamed and removed names in a folder survive a power cut. Throws Error(output).
void sync_folder(const std::filesystem::path& folder);

/// Throws Error(output).
void rename_path(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace kissmap
