// SPDX-License-Identifier: MIT
#include "formats/session/pack_log.hpp"

#include <zstd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <system_error>

#include "formats/files/xxh3.hpp"
#include "formats/session/manifest_json.hpp"
#include "formats/session/pack_frame.hpp"
#include "formats/session/pack_scan.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/pack.hpp"
#include "kissmap/formats/session.hpp"

namespace kissmap {
namespace {

constexpr const char* cure = "make the pack again with 'kissmap pack', or restore it from a copy";

std::string decompress(const std::string& stored, std::size_t size) {
  if (ZSTD_getFrameContentSize(stored.data(), stored.size()) != size) {
    throw DamagedPack("the compressed scan has another size than its frame says");
  }
  std::string bytes(size, '\0');
  const std::size_t result = ZSTD_decompress(bytes.data(), size, stored.data(), stored.size());
  if (ZSTD_isError(result) || result != size) throw DamagedPack("the scan cannot be decompressed");
  return bytes;
}

LogEntry decode(const FrameHeader& header, const std::string& stored) {
  if (xxh3_64(stored) != header.stored_xxh3) throw DamagedPack("the checksum does not match");
  const std::string bytes = decompress(stored, header.unpacked_size);
  return header.kind == FrameKind::scan ? decode_scan(bytes) : decode_refusal(bytes);
}

class PackedLog : public ScanLog {
 public:
  PackedLog(std::filesystem::path file, LogInfo info)
      : file_(std::move(file)), info_(std::move(info)), stream_(file_, std::ios::binary) {
    std::error_code code;
    size_ = std::filesystem::file_size(file_, code);
    if (code || !stream_) throw input_error(file_, "cannot be opened; check the path");
    info_.scan_count = read_entry_count();
    read_file_header();
  }

  const LogInfo& info() const override { return info_; }

  std::optional<LogEntry> next() override {
    const std::uint64_t place = position_;
    const FrameHeader header = next_frame();
    if (header.kind == FrameKind::end) return std::nullopt;
    const std::string stored = read(header.stored_size);
    return decoded(header, stored, place);
  }

  void skip(std::size_t count) override {
    for (; count > 0; --count) {
      const FrameHeader header = next_frame();
      if (header.kind == FrameKind::end) return;
      position_ += header.stored_size;
      stream_.seekg(static_cast<std::streamoff>(position_));
      hashed_ = std::numeric_limits<std::uint64_t>::max();
    }
  }

  std::vector<LogFile> files() const override {
    const bool read_through = hashed_ == size_;
    return {{file_.filename().string(), size_, read_through ? hash_.hex() : std::string()}};
  }

 private:
  Error damaged(std::uint64_t place, const std::string& message) const {
    return input_error(file_, "byte " + std::to_string(place) + ": " + message + "; " + cure);
  }

  // The end frame is the last thing written: without it the pack was never finished.
  std::size_t read_entry_count() {
    if (size_ < pack_header_size + frame_header_size) throw damaged(size_, "the pack is cut off");
    std::string bytes(frame_header_size, '\0');
    stream_.seekg(static_cast<std::streamoff>(size_ - frame_header_size));
    stream_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream_.seekg(0);
    if (!stream_) throw damaged(size_ - frame_header_size, "cannot be read");
    try {
      const FrameHeader end = parse_frame_header(bytes);
      if (end.kind == FrameKind::end) return end.index;
    } catch (const DamagedPack&) {
    }
    throw damaged(size_, "the pack is cut off or was never finished");
  }

  void read_file_header() {
    try {
      require_pack_header(read(pack_header_size));
    } catch (const DamagedPack& error) {
      throw damaged(0, error.what());
    }
  }

  // At the end of the log this frame stays the next one.
  FrameHeader next_frame() {
    if (ended_) return {};
    const std::uint64_t place = position_;
    try {
      const FrameHeader header = parse_frame_header(read(frame_header_size));
      require_possible(header);
      ended_ = header.kind == FrameKind::end;
      ++entries_;
      return header;
    } catch (const DamagedPack& error) {
      throw damaged(place, error.what());
    }
  }

  void require_possible(const FrameHeader& header) const {
    const bool is_end = header.kind == FrameKind::end;
    if (header.stored_size > size_ - position_) throw DamagedPack("a scan ends after the file");
    if (is_end && position_ != size_) throw DamagedPack("the pack goes on after its end");
    if (is_end && header.index != entries_) throw DamagedPack("scans are missing before the end");
  }

  LogEntry decoded(const FrameHeader& header,
                   const std::string& stored,
                   std::uint64_t place) const {
    LogEntry entry;
    try {
      entry = decode(header, stored);
    } catch (const DamagedPack& error) {
      entry.name = file_.filename().string() + " byte " + std::to_string(place);
      entry.content = RefusedScan{"damaged in the pack", damaged(place, error.what()).what()};
    }
    entry.index = header.index;
    return entry;
  }

  std::string read(std::size_t count) {
    if (count > size_ - position_) throw damaged(position_, "the pack is cut off");
    std::string bytes(count, '\0');
    if (!stream_.read(bytes.data(), static_cast<std::streamsize>(count))) {
      throw damaged(position_, "cannot be read");
    }
    if (hashed_ == position_) {
      hash_.add(bytes);
      hashed_ += count;
    }
    position_ += count;
    return bytes;
  }

  std::filesystem::path file_;
  LogInfo info_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  std::uint64_t entries_ = 0;  // frames passed
  bool ended_ = false;
  Xxh3Stream hash_;
  std::uint64_t hashed_ = 0;  // bytes from the front in hash_; none once something was skipped
};

bool has_pack_magic(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string bytes(pack_header_size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return is_pack_start(
      std::string_view(bytes).substr(0, static_cast<std::size_t>(stream.gcount())));
}

std::filesystem::path pack_file(const std::filesystem::path& path) {
  std::error_code code;
  return std::filesystem::is_directory(path, code) ? path / pack_file_name : path;
}

std::string stamp_source(const std::filesystem::path& path) {
  if (!is_session(path)) return "pack";
  return read_manifest(path).manifest.log.stamp_source;
}

}  // namespace

bool probe_packed(const std::filesystem::path& path) try {
  return has_pack_magic(pack_file(path));
} catch (const std::exception&) {
  return false;
}

std::unique_ptr<ScanLog> open_packed(const std::filesystem::path& path,
                                     const ReadOptions& /*options*/) {
  LogInfo info;
  info.format = packed_format_name;
  info.path = path;
  info.stamp_source = stamp_source(path);
  return std::make_unique<PackedLog>(pack_file(path), std::move(info));
}

}  // namespace kissmap
