// SPDX-License-Identifier: MIT
#include "map_log.hpp"

#include <utility>

#include "kissmap/error.hpp"
#include "kissmap/parallel/task_thread.hpp"

namespace kissmap {
namespace {

constexpr std::size_t most_waiting = 16;  // scans or local maps, up to some megabytes each

/// Keeps the books of a run.
class Books {
 public:
  MappedLog totals;

  void refuse(const LogEntry& entry, const std::string& reason, const std::string& detail) {
    Refusals& refusals = totals.counts.scans_refused[reason];
    ++refusals.count;
    if (refusals.examples.size() < max_refusal_examples) {
      refusals.examples.push_back(detail.empty() ? entry.name : entry.name + ": " + detail);
    }
  }

  void use(const LogEntry& entry, const MappedScan& scan, bool stamp_is_index) {
    SessionCounts& counts = totals.counts;
    ++counts.scans_used;
    counts.scans_not_converged += scan.converged ? 0 : 1;
    counts.points_read += scan.points_read;
    counts.points_out_of_range += scan.points_read - scan.points_in_range;
    gaps_.observe(entry.index, scan.stamp_ns);
    if (last_) {
      totals.path_length +=
          (last_->map_from_lidar.inverse() * scan.map_from_lidar).translation.norm();
    } else {
      first_stamp_ = scan.pose_stamp_ns;
    }
    if (!stamp_is_index) {
      totals.log_seconds = 1e-9 * static_cast<double>(scan.pose_stamp_ns - first_stamp_);
    }
    last_ = scan;
    totals.places.push_back({scan.local_map_id, scan.local_map_from_lidar});
  }

  MappedLog finish() {
    totals.counts.gaps = gaps_.gaps();
    return totals;
  }

 private:
  StampGaps gaps_;
  std::optional<MappedScan> last_;
  std::int64_t first_stamp_ = 0;
};

/// Reads a log one scan ahead, to tell a scan whose stamp jumps forward from one that is late: the
/// mapper takes stamps in ascending order, and one far ahead would cost it all scans after.
class StampWatch {
 public:
  explicit StampWatch(ScanLog& log) : log_(log), coming_(log.next()) {}

  std::optional<LogEntry> next() {
    if (current_stamp_ && !ahead_of_next()) last_stamp_ = current_stamp_;
    std::optional<LogEntry> current = std::exchange(coming_, std::nullopt);
    if (current) coming_ = log_.next();
    current_stamp_ = stamp_of(current);
    return current;
  }

  /// True if the scan after the current one is earlier, but not earlier than the one before.
  bool ahead_of_next() const {
    const std::optional<std::int64_t> next = stamp_of(coming_);
    if (!current_stamp_ || !next || *next >= *current_stamp_) return false;
    return !last_stamp_ || *next > *last_stamp_;
  }

 private:
  static std::optional<std::int64_t> stamp_of(const std::optional<LogEntry>& entry) {
    const Scan* scan = entry ? std::get_if<Scan>(&entry->content) : nullptr;
    return scan == nullptr ? std::nullopt : std::optional(scan->stamp_ns);
  }

  ScanLog& log_;
  std::optional<LogEntry> coming_;
  std::optional<std::int64_t> current_stamp_;
  std::optional<std::int64_t> last_stamp_;
};

[[noreturn]] void refuse_log(const ScanLog& log, const SessionCounts& counts) {
  if (counts.scans_read == 0) throw input_error(log.info().path, "holds no scan");
  std::string message = "no scan of " + std::to_string(counts.scans_read) + " can be used";
  for (const auto& [reason, refusals] : counts.scans_refused) {
    message += "\n  " + std::to_string(refusals.count) + " x " + reason + ", for example " +
               refusals.examples.front();
  }
  throw input_error(log.info().path, message);
}

}  // namespace

MappedLog map_log(ScanLog& log,
                  Mapper& mapper,
                  const RunOutputs& outputs,
                  const std::function<void(const RunProgress&)>& progress) {
  Books books;
  TaskThread beside(most_waiting);
  const auto write_map = [&](std::optional<LocalMap> closed) {
    if (!closed) return;
    outputs.session.add_local_map(*closed);
    beside.add([&loops = outputs.loops, local_map = std::move(*closed)] { loops.add(local_map); });
    ++books.totals.local_maps;
  };
  StampWatch stamps(log);
  while (const std::optional<LogEntry> entry = stamps.next()) {
    ++books.totals.counts.scans_read;
    if (outputs.pack != nullptr) outputs.pack->add(*entry);
    if (stamps.ahead_of_next()) {
      books.refuse(*entry, "stamp later than that of the scan after", "");
      continue;
    }
    if (const auto* refused = std::get_if<RefusedScan>(&entry->content)) {
      books.refuse(*entry, refused->reason, refused->detail);
      continue;
    }
    const auto& scan = std::get<Scan>(entry->content);
    books.totals.counts.points_dropped += scan.dropped;
    MapperStep step = mapper.add(scan);
    if (const auto* refusal = std::get_if<ScanRefusal>(&step.scan)) {
      books.refuse(*entry, to_string(*refusal), "");
      continue;
    }
    const auto& mapped = std::get<MappedScan>(step.scan);
    books.use(*entry, mapped, scan.stamp_is_index);
    outputs.session.add_scan({entry->index, mapped});
    if (outputs.stretches != nullptr) {
      beside.add([&stretches = *outputs.stretches, thinned = thinned_for_stretches(scan), mapped] {
        stretches.add(thinned, mapped);
      });
    }
    write_map(std::move(step.closed));
    progress({books.totals.counts.scans_read,
              log.info().scan_count,
              books.totals.log_seconds,
              books.totals.path_length});
  }
  if (books.totals.counts.scans_used == 0) refuse_log(log, books.totals.counts);
  write_map(mapper.finish());
  beside.finish();
  if (outputs.stretches != nullptr) outputs.stretches->finish();
  return books.finish();
}

}  // namespace kissmap
