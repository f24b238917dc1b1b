// SPDX-License-Identifier: MIT
#include "kissmap/parallel/thread_pool.hpp"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace kissmap {
namespace {

int usable_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  const int count = sched_getaffinity(0, sizeof(set), &set) == 0 ? CPU_COUNT(&set) : 0;
  return std::max(1, count);
}

}  // namespace

class ThreadPool::Workers {
 public:
  explicit Workers(int threads) {
    for (int i = 1; i < threads; ++i) threads_.emplace_back([this] { serve(); });
  }

  ~Workers() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  int size() const { return static_cast<int>(threads_.size()) + 1; }

  void run(std::size_t chunks, const std::function<void(std::size_t)>& body) {
    {
      const std::lock_guard lock(mutex_);
      body_ = &body;
      chunks_ = chunks;
      next_.store(0, std::memory_order_relaxed);
      error_ = nullptr;
      busy_ = static_cast<int>(threads_.size());
      ++round_;
    }
    wake_.notify_all();
    work();
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [this] { return busy_ == 0; });
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  void serve() {
    unsigned seen = 0;
    std::unique_lock lock(mutex_);
    while (true) {
      wake_.wait(lock, [&] { return stop_ || round_ != seen; });
      if (stop_) return;
      seen = round_;
      lock.unlock();
      work();
      lock.lock();
      if (--busy_ == 0) idle_.notify_one();
    }
  }

  void work() {
    for (std::size_t i = next_.fetch_add(1); i < chunks_; i = next_.fetch_add(1)) {
      try {
        (*body_)(i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
      }
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable idle_;
  std::atomic<std::size_t> next_{0};
  const std::function<void(std::size_t)>* body_ = nullptr;
  std::size_t chunks_ = 0;
  std::exception_ptr error_;
  int busy_ = 0;
  unsigned round_ = 0;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

ThreadPool::ThreadPool(int threads)
    : workers_(std::make_unique<Workers>(threads > 0 ? threads : usable_processors())) {
}

ThreadPool::~ThreadPool() = default;

int ThreadPool::size() const {
  return workers_->size();
}

void ThreadPool::for_each_chunk(std::size_t chunks,
                                const std::function<void(std::size_t chunk)>& body) {
  if (workers_->size() == 1 || chunks <= 1) {
    for (std::size_t i = 0; i < chunks; ++i) body(i);
    return;
  }
  workers_->run(chunks, body);
}

}  // namespace kissmap
