// SPDX-License-Identifier: MIT
#include "formats/logs/folder_log.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "formats/clouds/refusal.hpp"
#include "formats/files/input_file.hpp"
#include "formats/files/xxh3.hpp"
#include "formats/text/stamps.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

std::optional<std::pair<std::int64_t, std::int64_t>> range_of(const FolderContent& content) {
  std::optional<std::pair<std::int64_t, std::int64_t>> range;
  if (content.stamps_are_indices) return range;
  for (const ScanFile& scan : content.scans) {
    if (!scan.stamp_ns) continue;
    if (!range) range.emplace(*scan.stamp_ns, *scan.stamp_ns);
    range->first = std::min(range->first, *scan.stamp_ns);
    range->second = std::max(range->second, *scan.stamp_ns);
  }
  return range;
}

}  // namespace

FolderLog::FolderLog(FolderContent content)
    : content_(std::move(content)), hashes_(content_.scans.size()) {
  content_.info.scan_count = content_.scans.size();
  content_.info.time_range = range_of(content_);
}

std::optional<LogEntry> FolderLog::next() {
  if (peeked_) return std::exchange(peeked_, std::nullopt);
  if (next_index_ >= content_.scans.size()) return std::nullopt;
  return read(next_index_++);
}

const LogEntry* FolderLog::peek() {
  if (!peeked_) peeked_ = next();
  return peeked_ ? &*peeked_ : nullptr;
}

void FolderLog::skip(std::size_t count) {
  if (count > 0 && peeked_) {
    peeked_.reset();
    --count;
  }
  next_index_ += std::min(count, content_.scans.size() - next_index_);
}

std::optional<std::vector<std::int64_t>> FolderLog::known_times() {
  if (content_.stamps_are_indices) return std::nullopt;
  std::vector<std::int64_t> times;
  for (const ScanFile& scan : content_.scans) {
    if (!scan.stamp_ns) return std::nullopt;
    times.push_back(*scan.stamp_ns);
  }
  return times;
}

LogEntry FolderLog::read(std::size_t index) {
  ScanFile& file = content_.scans[index];
  LogEntry entry{index, file.name, Scan{}};
  try {
    read_file(file.path, buffer_);
    file.size_bytes = buffer_.size();
    hashes_[index] = xxh3_hex(buffer_);
    if (!file.stamp_ns) {
      throw Refusal(refusal_reason::no_stamp,
                    "there is no stamp for it in " + content_.info.stamp_source);
    }
    Scan scan = content_.decode(buffer_, index);
    scan.stamp_is_index = content_.stamps_are_indices;
    entry.content = std::move(scan);
  } catch (const Refusal& refusal) {
    entry.content = RefusedScan{refusal.reason(), file.path.string() + ": " + refusal.what()};
  }
  return entry;
}

std::vector<LogFile> FolderLog::files() const {
  std::vector<LogFile> files = content_.side_files;
  for (std::size_t i = 0; i < content_.scans.size(); ++i) {
    files.push_back({content_.scans[i].name, content_.scans[i].size_bytes, hashes_[i]});
  }
  return files;
}

std::vector<ScanFile> list_files(const std::filesystem::path& folder,
                                 const std::string& prefix,
                                 const std::function<bool(const std::filesystem::path&)>& accept) {
  std::vector<ScanFile> files;
  try {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      std::error_code no_size;  // a link to nowhere stays in the list, to be refused by name
      if (name.starts_with('.') || !accept(entry.path()) || entry.is_directory(no_size)) continue;
      const auto size = entry.file_size(no_size);
      files.push_back({entry.path(), prefix + name, no_size ? 0 : size, std::nullopt});
    }
  } catch (const std::filesystem::filesystem_error& error) {
    throw input_error(folder, "cannot be listed: " + error.code().message());
  }
  std::ranges::sort(files, natural_less, &ScanFile::name);
  return files;
}

}  // namespace kissmap
