// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/loop_worker.hpp"

#include <utility>

namespace kissmap {
namespace {

constexpr std::size_t most_waiting = 4;  // each is some megabytes

}  // namespace

LoopWorker::LoopWorker(LoopCloser& loops)
    : loops_(loops), thread_([this](const std::stop_token& stop) { work(stop); }) {
}

LoopWorker::~LoopWorker() {
  thread_.request_stop();
}

void LoopWorker::add(LocalMap local_map) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return failure_ || waiting_.size() < most_waiting; });
  rethrow();
  waiting_.push_back(std::move(local_map));
  changed_.notify_all();
}

void LoopWorker::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return failure_ || (waiting_.empty() && !busy_); });
  rethrow();
}

void LoopWorker::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
    if (stop.stop_requested()) return;
    const LocalMap local_map = std::move(waiting_.front());
    waiting_.pop_front();
    busy_ = true;
    lock.unlock();
    std::exception_ptr failure;
    try {
      loops_.add(local_map);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    busy_ = false;
    failure_ = failure;
    changed_.notify_all();
    if (failure_) return;
  }
}

void LoopWorker::rethrow() {
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace kissmap
