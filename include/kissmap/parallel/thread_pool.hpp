// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace kissmap {

/// A fixed set of worker threads for data-parallel loops. The caller works too, so a pool of one
/// has no thread of its own. One pool serves one caller at a time.
class ThreadPool {
 public:
  /// `threads` >= 1; 0 means one for each processor this process may use.
  explicit ThreadPool(int threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const;

  /// Calls body(chunk) for each chunk in 0..chunks-1, in any order and from any thread, and
  /// returns when all are done. The first exception thrown by a body is rethrown here.
  /// A result is the same for any number of threads if each chunk writes only to its own place
  /// and the caller combines those places in order.
  void for_each_chunk(std::size_t chunks, const std::function<void(std::size_t chunk)>& body);

 private:
  class Workers;
  std::unique_ptr<Workers> workers_;
};

}  // namespace kissmap
