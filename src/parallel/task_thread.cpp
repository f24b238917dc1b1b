// SPDX-License-Identifier: MIT
#include "kissmap/parallel/task_thread.hpp"

#include <utility>

namespace kissmap {

TaskThread::TaskThread(std::size_t most_waiting)
    : most_waiting_(most_waiting), thread_([this](const std::stop_token& stop) { work(stop); }) {
}

TaskThread::~TaskThread() {
  thread_.request_stop();
}

void TaskThread::add(std::function<void()> task) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return failure_ || waiting_.size() < most_waiting_; });
  rethrow();
  waiting_.push_back(std::move(task));
  changed_.notify_all();
}

void TaskThread::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return failure_ || (waiting_.empty() && !busy_); });
  rethrow();
}

void TaskThread::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
    if (stop.stop_requested()) return;
    std::function<void()> task = std::move(waiting_.front());
    waiting_.pop_front();
    busy_ = true;
    lock.unlock();
    std::exception_ptr failure;
    try {
      task();
      task = nullptr;  // what it holds is freed here, not under the lock
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

void TaskThread::rethrow() {
  if (failure_) std::rethrow_exception(failure_);
}

}  // namespace kissmap
