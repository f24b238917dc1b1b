// SPDX-License-Identifier: MIT
#include "kissmap/formats/session_replay.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

/// The entry at `log_index`; those before it are of no use to the session.
LogEntry find_entry(ScanLog& log, std::uint64_t log_index) {
  while (std::optional<LogEntry> entry = log.next()) {
    if (entry->index == log_index) return std::move(*entry);
  }
  throw input_error(log.info().path,
                    "ends before scan " + std::to_string(log_index) +
                        ", which the session has mapped; restore the log, or map it again");
}

}  // namespace

SessionReplay::SessionReplay(const Session& session,
                             double min_range,
                             double max_range,
                             const std::filesystem::path& moved_to,
                             std::uint64_t every,
                             NoReturns no_returns)
    : session_(session),
      log_(open_session_log(session, moved_to)),
      min_range_(min_range),
      max_range_(max_range),
      every_(every),
      no_returns_(no_returns) {
  if (every_ == 1) log_ = read_ahead(std::move(log_));
}

std::optional<PlacedScan> SessionReplay::next() {
  if (next_idx_ >= session_.scans.size()) return std::nullopt;
  const SessionScan& row = session_.scans[next_idx_];
  const LogEntry entry = find_entry(*log_, row.log_index);
  const auto* scan = std::get_if<Scan>(&entry.content);
  if (scan == nullptr || scan->stamp_ns != row.mapped.stamp_ns) {
    throw input_error(log_->info().path,
                      entry.name +
                          " is not the scan the session has mapped; restore the log, or "
                          "map it again");
  }
  const MappedScan* before = next_idx_ == 0 ? nullptr : &session_.scans[next_idx_ - 1].mapped;
  PlacedScan placed = place_scan(*scan, before, row.mapped, min_range_, max_range_);
  if (no_returns_ == NoReturns::placed) place_no_returns(*scan, before, row.mapped, placed);
  placed.scan_idx = next_idx_;
  next_idx_ += every_;
  if (every_ > 1 && next_idx_ < session_.scans.size()) {
    // Entries of the log lie apart by the session's own selection, refused ones among them.
    const std::uint64_t apart = session_.scans[next_idx_].log_index - row.log_index;
    const std::uint64_t step = std::max<std::uint64_t>(1, session_.manifest.log.selection.every);
    if (apart > step) log_->skip(apart / step - 1);
  }
  return placed;
}

}  // namespace kissmap
