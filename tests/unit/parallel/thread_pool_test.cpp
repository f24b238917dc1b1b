// SPDX-License-Identifier: MIT
#include "kissmap/parallel/thread_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace kissmap {
namespace {

TEST(ThreadPool, RunsEveryChunkOnceRoundAfterRound) {
  for (const int threads : {1, 2, 7}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.size(), threads);
    for (std::size_t chunks = 0; chunks < 300; ++chunks) {
      std::vector<int> runs(chunks, 0);
      pool.for_each_chunk(chunks, [&](std::size_t chunk) { ++runs[chunk]; });
      ASSERT_EQ(runs, std::vector<int>(chunks, 1));
    }
  }
}

TEST(ThreadPool, RethrowsAndStaysUsable) {
  ThreadPool pool(4);
  EXPECT_THROW(pool.for_each_chunk(100,
                                   [](std::size_t chunk) {
                                     if (chunk == 57) throw std::runtime_error("57");
                                   }),
               std::runtime_error);
  std::atomic<int> sum{0};
  pool.for_each_chunk(10, [&](std::size_t chunk) { sum += static_cast<int>(chunk); });
  EXPECT_EQ(sum, 45);
}

TEST(ThreadPool, ZeroMeansOneForEachProcessor) {
  EXPECT_GE(ThreadPool(0).size(), 1);
}

}  // namespace
}  // namespace kissmap
