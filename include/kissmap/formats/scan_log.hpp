// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "kissmap/cloud/scan.hpp"

namespace kissmap {

/// What a user may tell a reader that the log itself does not say.
struct ReadOptions {
  bool kitti_elevation_correction = true;  ///< KITTI odometry only: raise points by 0.205 degrees
  std::string time_field;  ///< name of the per-point time field; empty: found by rule
  std::string time_unit;   ///< s, ms, us, ns or none (no times); empty: found by rule
  int bin_columns = 0;     ///< float32 columns of a headerless .bin; 0: found by rule
  /// Topic of a bag or MCAP file, port of a capture, scene of nuScenes; empty: the only one.
  std::string topic;
  /// What came with the sensor whose packets are recorded: a Hesai's angles (.csv), the ROS
  /// driver's file of an HDL-64E (.yaml), an Ouster's metadata (.json); empty: none, or found
  /// beside the log.
  std::string calibration;
};
/// Throws Error(usage) naming the field.
void require_valid(const ReadOptions& options);

/// One file of a log, as it was when read.
struct LogFile {
  std::string name;  ///< relative to the log's folder, '/' as separator
  std::uint64_t size_bytes = 0;
  std::string xxh3;  ///< XXH3-128 of the content, 32 hex digits; empty if not read
  friend bool operator==(const LogFile&, const LogFile&) = default;
};

/// A stream of messages in a bag or MCAP file, or of datagrams to one port in a capture.
struct LogTopic {
  std::string name;  ///< or the port
  std::string type;
  std::optional<std::uint64_t> message_count;  ///< none where only reading to the end can tell
};

/// What is known of a log before its scans are read.
struct LogInfo {
  std::string format;  ///< name in the list of formats
  std::filesystem::path path;
  std::optional<std::size_t> scan_count;  ///< none where only reading to the end can tell
  std::string stamp_source;               ///< "times.txt", "file names", "index" ...
  /// First and last stamp, or time of recording [ns]; none where only reading can tell.
  std::optional<std::pair<std::int64_t, std::int64_t>> time_range;
  std::string sensor;              ///< where the log tells
  std::string fields;              ///< of a point, with their types
  std::vector<LogTopic> topics;    ///< all of a bag or MCAP file; of a capture, those understood
  std::vector<std::string> notes;  ///< decisions the reader took, for the user
};

/// A scan that could not be read while the rest of the log can.
struct RefusedScan {
  std::string reason;  ///< short and the same for the same cause, so that it can be counted
  std::string detail;  ///< file, place and cure
};

struct LogEntry {
  std::size_t index = 0;  ///< position in the log, from 0; refused scans count
  std::string name;       ///< file or message, for reports
  std::variant<Scan, RefusedScan> content;
};

/// A recorded log, read once from front to back. Not thread safe.
class ScanLog {
 public:
  virtual ~ScanLog() = default;
  virtual const LogInfo& info() const = 0;

  /// The next scan in recorded order, or nothing at the end. One bad scan is an entry with a
  /// RefusedScan; throws Error(input) only when the log as a whole cannot be read on.
  virtual std::optional<LogEntry> next() = 0;

  /// Passes over `count` scans, without decoding them where the format allows.
  virtual void skip(std::size_t count);

  /// Stamps of all scans in recorded order, or when they were recorded [ns], where names of files,
  /// a table or an index tell them without much being read; otherwise nothing. Before the first
  /// next().
  virtual std::optional<std::vector<std::int64_t>> known_times() { return std::nullopt; }

  /// Every file of the log, hashed where it has been read so far.
  virtual std::vector<LogFile> files() const = 0;
};

/// Part of a log: scans first, first + every, ... up to and including last, by index from 0.
struct ScanSelection {
  std::size_t first = 0;
  std::optional<std::size_t> last;
  std::size_t every = 1;
  friend bool operator==(const ScanSelection&, const ScanSelection&) = default;
};
/// Throws Error(usage) when nothing can be selected.
void require_valid(const ScanSelection& selection);
/// The log restricted to a selection; entries keep their index in the whole log.
std::unique_ptr<ScanLog> select_scans(std::unique_ptr<ScanLog> log, const ScanSelection& selection);

/// The same log, read and decoded ahead on a thread of its own. At most `max_scans` decoded scans
/// wait at any time. Errors arrive in order, from next(). files() may be called after the end.
std::unique_ptr<ScanLog> read_ahead(std::unique_ptr<ScanLog> log, std::size_t max_scans = 4);

}  // namespace kissmap
