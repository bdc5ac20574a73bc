// SPDX-License-Identifier: Apache-2.0
// The film queue: order, waiting, dropping and errors of its thread.
#include "firmware/host/film/film_queue.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <stdexcept>
#include <vector>

namespace fovea::film {
namespace {

TEST(FilmQueueTest, WaitingProducerLosesNothingToASlowWorker) {
  std::vector<int> seen;
  FilmQueue<int> queue(/*may_drop=*/false, [&seen](int& item) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    seen.push_back(item);
  });
  for (int i = 0; i < 50; ++i) {
    std::optional<int> place = queue.Take();
    ASSERT_TRUE(place.has_value());
    queue.Put(i);
  }
  queue.Finish();
  ASSERT_EQ(seen.size(), 50U);
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(seen[static_cast<std::size_t>(i)], i);
  }
  EXPECT_EQ(queue.dropped(), 0U);
}

TEST(FilmQueueTest, DroppingProducerNeverWaits) {
  std::promise<void> go_on;
  std::uint64_t seen = 0;
  FilmQueue<int> queue(/*may_drop=*/true, [&, wait = go_on.get_future().share()](int&) {
    wait.wait();
    ++seen;
  });
  std::uint64_t put = 0;
  for (int i = 0; i < 100; ++i) {
    if (queue.Take()) {
      queue.Put(i);
      ++put;
    }
  }
  EXPECT_LE(put, 9U) << "the queue is not bounded";
  EXPECT_EQ(queue.dropped(), 100U - put);
  go_on.set_value();
  queue.Finish();
  EXPECT_EQ(seen, put);
}

TEST(FilmQueueTest, WorkerExceptionIsRethrownByFinishAndBlocksNobody) {
  FilmQueue<int> queue(/*may_drop=*/false, [](int&) { throw std::runtime_error("the disk is full"); });
  for (int i = 0; i < 100; ++i) {
    if (queue.Take()) {
      queue.Put(i);
    }
  }
  EXPECT_GT(queue.dropped(), 0U);
  EXPECT_THROW(queue.Finish(), std::runtime_error);
}

}  // namespace
}  // namespace fovea::film
