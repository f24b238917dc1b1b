// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/clouds/record_layout.hpp"
#include "formats/clouds/time_rule.hpp"
#include "kissmap/cloud/scan.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {

/// Turns the point records of one log into scans: finds x, y, z, intensity and time among the
/// fields, drops what is no return, and puts times relative to the stamp. Remembers how the log
/// writes time, so that a short scan is not read in another unit than its neighbours.
/// Not thread safe.
class ScanDecoder {
 public:
  explicit ScanDecoder(const ReadOptions& options) : options_(options) {}

  /// Compensation is left unknown. Throws Refusal when fields are missing or lie outside of the
  /// bytes.
  Scan decode(const PointRecords& records, std::int64_t stamp_ns);

  /// What was decided about times with the scan decoded last, for the user.
  const std::string& time_note() const { return time_note_; }

  /// Names and types of the fields of the first scan decoded: "x f32, y f32, ring u16".
  const std::string& fields() const { return fields_; }

 private:
  const RecordField* time_field(const RecordLayout& layout) const;
  void apply_times(const RecordField& field, const RawTimes& times, Scan& scan);

  ReadOptions options_;
  std::optional<TimeReading> settled_;
  std::string time_note_;
  std::string fields_;
};

}  // namespace kissmap
