// SPDX-License-Identifier: MIT
#include "formats/session/verified_log.hpp"

#include <algorithm>
#include <utility>

#include "formats/session/manifest_json.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

constexpr const char* cure =
    "the log changed since the session was made; give the original with --log, or make the "
    "session again with 'kissmap run'";

std::vector<LogFile> sorted_by_name(std::vector<LogFile> files) {
  std::ranges::sort(files, {}, &LogFile::name);
  return files;
}

class VerifiedLog : public ScanLog {
 public:
  VerifiedLog(std::unique_ptr<ScanLog> log, std::vector<LogFile> expected)
      : log_(std::move(log)),
        expected_(sorted_by_name(std::move(expected))),
        // files() copies its list: asked after every scan, a log of many files would cost a square.
        scans_between_checks_(1 + expected_.size() / 64) {
    check();
  }

  const LogInfo& info() const override { return log_->info(); }
  std::vector<LogFile> files() const override { return log_->files(); }

  std::optional<LogEntry> next() override {
    std::optional<LogEntry> entry = log_->next();
    if (!entry || ++scans_since_check_ >= scans_between_checks_) check();
    return entry;
  }

  void skip(std::size_t count) override { log_->skip(count); }

 private:
  Error changed(const std::string& name, const std::string& difference) const {
    return input_error(log_->info().path, "file '" + name + "' " + difference + "; " + cure);
  }

  void check() {
    scans_since_check_ = 0;
    std::vector<LogFile> found = log_->files();
    for (LogFile& file : found) file.name = as_json_stores_it(file.name);
    found = sorted_by_name(std::move(found));
    const std::size_t common = std::min(found.size(), expected_.size());
    for (std::size_t i = 0; i < common; ++i) require_same(found[i], expected_[i]);
    if (found.size() > common) throw changed(found[common].name, "is new");
    if (expected_.size() > common) throw changed(expected_[common].name, "is missing");
  }

  void require_same(const LogFile& found, const LogFile& expected) const {
    const std::string& name = found.name;
    if (name < expected.name) throw changed(name, "is new");
    if (name > expected.name) throw changed(expected.name, "is missing");
    if (found.size_bytes != expected.size_bytes) {
      throw changed(name,
                    "has " + std::to_string(found.size_bytes) + " bytes instead of " +
                        std::to_string(expected.size_bytes));
    }
    const bool both_read = !found.xxh3.empty() && !expected.xxh3.empty();
    if (both_read && found.xxh3 != expected.xxh3) throw changed(name, "has other content");
  }

  std::unique_ptr<ScanLog> log_;
  std::vector<LogFile> expected_;
  std::size_t scans_between_checks_;
  std::size_t scans_since_check_ = 0;
};

}  // namespace

std::unique_ptr<ScanLog> verify_log(std::unique_ptr<ScanLog> log, std::vector<LogFile> expected) {
  return std::make_unique<VerifiedLog>(std::move(log), std::move(expected));
}

}  // namespace kissmap
