// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace kissmap {

/// Does one task after the other, in the order given, on a thread of its own, beside the caller.
/// What tasks write is the caller's again after finish().
class TaskThread {
 public:
  /// add() waits while `most_waiting` tasks wait: each holds what it works on.
  explicit TaskThread(std::size_t most_waiting);
  /// Leaves what waits undone.
  ~TaskThread();
  TaskThread(const TaskThread&) = delete;
  TaskThread& operator=(const TaskThread&) = delete;

  /// Throws what an earlier task threw; nothing is done after that.
  void add(std::function<void()> task);

  /// Returns when all is done. Throws what a task threw.
  void finish();

 private:
  void work(const std::stop_token& stop);
  void rethrow();

  std::size_t most_waiting_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::function<void()>> waiting_;
  bool busy_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;  ///< last, so that it ends before the rest
};

}  // namespace kissmap
