// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "kissmap/loop_closing/loop_closer.hpp"

namespace kissmap {

/// Looks for loops on a thread of its own while the log is read on. What is found does not reach
/// back into odometry, so the result is that of adding local maps one by one.
class LoopWorker {
 public:
  /// `loops` must outlive the worker and is its own until finish().
  explicit LoopWorker(LoopCloser& loops);
  /// Leaves what waits undone.
  ~LoopWorker();

  /// Hands over a local map; waits while several wait. Throws what looking for loops threw.
  void add(LocalMap local_map);

  /// Returns when all is done. Throws what looking for loops threw.
  void finish();

 private:
  void work(const std::stop_token& stop);
  void rethrow();

  LoopCloser& loops_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<LocalMap> waiting_;
  bool busy_ = false;
  std::exception_ptr failure_;
  std::jthread thread_;  ///< last, so that it ends before the rest
};

}  // namespace kissmap
