// SPDX-License-Identifier: MIT
#include "kissmap/parallel/task_thread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numeric>
#include <vector>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

TEST(TaskThreadTest, DoesAllTasksInTheirOrder) {
  std::vector<int> done;
  TaskThread thread(3);
  for (int i = 0; i < 1000; ++i) thread.add([&done, i] { done.push_back(i); });
  thread.finish();
  std::vector<int> expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(done, expected);
  thread.add([&done] { done.clear(); });
  thread.finish();
  EXPECT_TRUE(done.empty()) << "it goes on after finish()";
}

TEST(TaskThreadTest, NoMoreThanAskedForWait) {
  std::atomic<int> held = 0;
  std::atomic<int> most = 0;
  TaskThread thread(2);
  for (int i = 0; i < 20; ++i) {
    ++held;
    thread.add([&] {
      most = std::max<int>(most, held);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      --held;
    });
  }
  thread.finish();
  EXPECT_LE(most, 4) << "two wait, one is done, one is being added";
}

TEST(TaskThreadTest, AFailureReachesTheCallerWhereverItIs) {
  TaskThread thread(4);
  const auto feed = [&thread] {
    for (int i = 0; i < 8; ++i) {
      thread.add([] { throw Error(Fault::input, "the disk is gone"); });
    }
    thread.finish();
  };
  EXPECT_THAT(feed, testing::ThrowsMessage<Error>("the disk is gone"));
  // Nobody takes what comes now: neither may wait for it.
  EXPECT_THAT(feed, testing::ThrowsMessage<Error>("the disk is gone"));
  EXPECT_THAT([&thread] { thread.finish(); }, testing::ThrowsMessage<Error>("the disk is gone"));
}

TEST(TaskThreadTest, LeftEarlyItEndsAndLeavesTheRestUndone) {
  std::atomic<int> done = 0;
  {
    TaskThread thread(8);
    for (int i = 0; i < 4; ++i) {
      thread.add([&done] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        ++done;
      });
    }
  }
  EXPECT_LE(done, 2);
}

}  // namespace
}  // namespace kissmap
