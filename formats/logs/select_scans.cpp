// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "kissmap/error.hpp"
#include "kissmap/formats/scan_log.hpp"

namespace kissmap {
namespace {

class SelectedLog : public ScanLog {
 public:
  SelectedLog(std::unique_ptr<ScanLog> log, const ScanSelection& selection)
      : log_(std::move(log)), selection_(selection), info_(log_->info()), wanted_(selection.first) {
    if (info_.scan_count) info_.scan_count = count_selected(*info_.scan_count);
  }

  const LogInfo& info() const override { return info_; }
  std::vector<LogFile> files() const override { return log_->files(); }

  std::optional<LogEntry> next() override {
    if (wanted_ > last()) return std::nullopt;
    log_->skip(wanted_ - position_);
    position_ = wanted_ + 1;
    advance(1);
    return log_->next();
  }

  void skip(std::size_t count) override { advance(count); }

 private:
  std::size_t last() const { return std::min(selection_.last.value_or(never), never - 1); }

  // Counts without wrapping: `every` may be any number.
  void advance(std::size_t count) {
    std::size_t step = 0;
    if (__builtin_mul_overflow(count, selection_.every, &step) ||
        __builtin_add_overflow(wanted_, step, &wanted_)) {
      wanted_ = never;
    }
  }

  std::size_t count_selected(std::size_t whole) const {
    const std::size_t end = std::min(whole, last() + 1);
    if (selection_.first >= end) return 0;
    return (end - 1 - selection_.first) / selection_.every + 1;
  }

  static constexpr std::size_t never = static_cast<std::size_t>(-1);
  std::unique_ptr<ScanLog> log_;
  ScanSelection selection_;
  LogInfo info_;
  std::size_t position_ = 0;  ///< of the next scan of the whole log
  std::size_t wanted_;        ///< index of the next selected scan
};

}  // namespace

void require_valid(const ScanSelection& selection) {
  if (selection.every == 0) throw usage_error("every: 0 selects no scan; 1 takes each");
  if (selection.last && *selection.last < selection.first) {
    throw usage_error("last: " + std::to_string(*selection.last) + " lies before first, " +
                      std::to_string(selection.first));
  }
}

std::unique_ptr<ScanLog> select_scans(std::unique_ptr<ScanLog> log,
                                      const ScanSelection& selection) {
  require_valid(selection);
  const auto count = log->info().scan_count;
  if (count && *count > 0 && selection.first >= *count) {
    throw usage_error("first: " + std::to_string(selection.first) +
                      ", but the log ends with scan " + std::to_string(*count - 1));
  }
  if (selection == ScanSelection{}) return log;
  return std::make_unique<SelectedLog>(std::move(log), selection);
}

}  // namespace kissmap
