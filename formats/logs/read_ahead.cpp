// SPDX-License-Identifier: MIT
#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "kissmap/formats/scan_log.hpp"

namespace kissmap {
namespace {

/// One thread reads, one takes; `queue_mutex_` guards what they share. `log_mutex_` keeps files()
/// apart from a read that is under way.
class ReadAheadLog : public ScanLog {
 public:
  ReadAheadLog(std::unique_ptr<ScanLog> log, std::size_t max_scans)
      : log_(std::move(log)),
        info_(log_->info()),
        max_scans_(std::max<std::size_t>(1, max_scans)) {}

  ~ReadAheadLog() override {
    {
      const std::lock_guard lock(queue_mutex_);
      stop_ = true;
    }
    room_.notify_all();
    if (reader_.joinable()) reader_.join();
  }

  const LogInfo& info() const override { return info_; }

  std::optional<LogEntry> next() override {
    start();
    std::unique_lock lock(queue_mutex_);
    filled_.wait(lock, [this] { return !queue_.empty() || ended_; });
    if (!queue_.empty()) {
      LogEntry entry = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      room_.notify_one();
      return entry;
    }
    lock.unlock();
    // Once it has joined, the reader holds no share of the exception: this thread alone frees it.
    if (reader_.joinable()) reader_.join();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
    return std::nullopt;
  }

  void skip(std::size_t count) override {
    // Before the first read the log itself can skip without decoding.
    if (started_) {
      ScanLog::skip(count);
    } else {
      log_->skip(count);
    }
  }

  std::optional<std::vector<std::int64_t>> known_times() override {
    return started_ ? std::nullopt : log_->known_times();
  }

  std::vector<LogFile> files() const override {
    const std::lock_guard lock(log_mutex_);
    return log_->files();
  }

 private:
  void start() {
    if (!std::exchange(started_, true)) reader_ = std::thread([this] { read(); });
  }

  void read() {
    try {
      while (wait_for_room()) {
        std::optional<LogEntry> entry = read_one();
        if (!entry) break;
        const std::lock_guard lock(queue_mutex_);
        queue_.push_back(std::move(*entry));
        filled_.notify_one();
      }
      end(nullptr);
    } catch (...) {
      end(std::current_exception());
    }
  }

  // False when nobody wants more.
  bool wait_for_room() {
    std::unique_lock lock(queue_mutex_);
    room_.wait(lock, [this] { return stop_ || queue_.size() < max_scans_; });
    return !stop_;
  }

  std::optional<LogEntry> read_one() {
    const std::lock_guard lock(log_mutex_);
    return log_->next();
  }

  void end(std::exception_ptr error) {
    const std::lock_guard lock(queue_mutex_);
    error_ = std::move(error);
    ended_ = true;
    filled_.notify_one();
  }

  std::unique_ptr<ScanLog> log_;
  const LogInfo info_;
  const std::size_t max_scans_;
  mutable std::mutex log_mutex_;
  std::mutex queue_mutex_;
  std::condition_variable room_;
  std::condition_variable filled_;
  std::deque<LogEntry> queue_;
  std::exception_ptr error_;
  bool ended_ = false;
  bool stop_ = false;
  bool started_ = false;  ///< the consumer's own
  std::thread reader_;
};

}  // namespace

std::unique_ptr<ScanLog> read_ahead(std::unique_ptr<ScanLog> log, std::size_t max_scans) {
  return std::make_unique<ReadAheadLog>(std::move(log), max_scans);
}

}  // namespace kissmap
