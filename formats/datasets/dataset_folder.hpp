// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/clouds/record_layout.hpp"
#include "formats/logs/folder_log.hpp"
#include "kissmap/geometry/rigid3.hpp"

namespace kissmap {

/// What a data set knows about its scans that the files themselves do not say.
struct DatasetScans {
  const char* format = "";
  std::filesystem::path path;    ///< the log, as the user gave it
  std::filesystem::path clouds;  ///< where its files lie, within path
  const char* extension = ".bin";
  std::string sensor;
  std::string stamp_source = "file names";
  std::vector<std::string> notes;
  StampInstant stamp_instant = StampInstant::unknown;  ///< unknown: the times of points tell
  Compensation compensation = Compensation::unknown;
  bool derived_times = false;  ///< times are computed here from the order of the points
  /// Stamp of a file; nothing: the scan is refused.
  std::function<std::optional<std::int64_t>(const std::filesystem::path&)> stamp_of;
  /// What sizes and stamps of all files tell the user, before any is read; may be left out.
  std::function<std::vector<std::string>(const std::vector<ScanFile>&)> notes_of;
  /// Bytes of a file, with its stamp -> points. Throws Refusal.
  std::function<PointRecords(std::span<const std::byte>, std::int64_t stamp_ns)> read;
};

/// The log of such scans, in the order of their stamps. Throws Error(input) if there is none.
std::unique_ptr<ScanLog> open_dataset(DatasetScans scans, const ReadOptions& options);

/// The stamp in the name of a file, however it is written there.
std::optional<std::int64_t> stamp_of_name(const std::filesystem::path& file);

/// Records of one size, packed. What is left over at the end of the file is passed over.
PointRecords packed_records(std::span<const std::byte> file,
                            std::vector<RecordField> fields,
                            std::size_t stride);

/// The same points with one more column of float32.
PointRecords with_column(const PointRecords& records,
                         const std::string& name,
                         const std::vector<float>& values);

/// Times [s] of a spinning sensor's points that are stored column by column, where there are
/// rings * columns of them; empty for any other number.
std::vector<float> column_times(std::size_t points,
                                std::size_t rings,
                                std::size_t columns,
                                double period);

/// The folder itself, absolute and without a slash at its end, so that it has a name and a parent.
std::filesystem::path folder_of(const std::filesystem::path& path);

/// One line that says where the LiDAR sits in `frame`, as `kissmap eval --mount` takes it.
std::string mount_note(const std::string& frame, const Rigid3& frame_from_lidar);

/// True if `folder` has a file with this extension whose stem is a stamp.
bool has_stamped_files(const std::filesystem::path& folder, const char* extension);

}  // namespace kissmap
