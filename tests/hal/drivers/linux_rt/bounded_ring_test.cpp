// SPDX-License-Identifier: Apache-2.0
// The ring between two threads: values stay in order and whole, and every dropped one is counted.
//
// Every value holds one number in all its fields, so that a torn value is detected. The thread
// sanitizer also reports a slot that both threads access at once.
// tests/models/bounded_ring.pml checks the same for every order of the steps.
#include "fovea/linux_rt/bounded_ring.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

namespace fovea::linux_rt {
namespace {

struct Story {
  std::uint64_t number = 0;
  std::array<std::uint64_t, 8> same{};
  std::uint64_t last = 0;
};

Story Make(std::uint64_t number) {
  Story story{number, {}, number};
  story.same.fill(number);
  return story;
}

bool IsWhole(const Story& story) {
  for (const std::uint64_t value : story.same) {
    if (value != story.number) {
      return false;
    }
  }
  return story.last == story.number;
}

class BoundedRingSizeTest : public testing::TestWithParam<std::size_t> {};

// The reader pauses now and then, so that the ring is full as often as it is empty.
TEST_P(BoundedRingSizeTest, TwoThreadsTakeOrCountEveryItem) {
  constexpr std::uint64_t kCount = 100'000;
  BoundedRing<Story> ring(GetParam());
  std::atomic<bool> done{false};
  std::uint64_t promised = 0;
  std::uint64_t broken = 0;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      const bool asked = i % 3 == 1;
      const bool has_room = asked && ring.HasRoom();
      const std::uint64_t before = ring.dropped();
      ring.Push(Make(i));
      promised += has_room ? 1U : 0U;
      broken += has_room && ring.dropped() != before ? 1U : 0U;
      if (i % 64 == 0) {
        std::this_thread::yield();
      }
    }
    done = true;
  });
  std::uint64_t taken = 0;
  std::uint64_t last = 0;
  std::uint64_t rounds = 0;
  bool whole = true;
  bool forward = true;
  const auto drain = [&] {
    const std::size_t count = ring.Drain(ring.End(), [&](const Story& story) {
      ++taken;
      whole = whole && IsWhole(story);
      forward = forward && story.number > last;
      last = story.number;
    });
    EXPECT_LE(count, GetParam());
  };
  while (!done) {
    drain();
    if (++rounds % 16 == 0) {
      std::this_thread::yield();
    }
  }
  writer.join();
  drain();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(forward);
  EXPECT_EQ(taken + ring.dropped(), kCount);
  EXPECT_EQ(broken, 0U) << "a Push after HasRoom() == true was dropped";
  EXPECT_GT(promised, 0U);
  EXPECT_GT(taken, 0U);
  std::printf("room for %zu: %llu taken, %llu dropped\n", GetParam(), static_cast<unsigned long long>(taken),
              static_cast<unsigned long long>(ring.dropped()));
}

// As for a log at lockstep pace: a writer that waits for room loses nothing.
TEST_P(BoundedRingSizeTest, WaitingWriterLosesNothing) {
  constexpr std::uint64_t kCount = 50'000;
  BoundedRing<Story> ring(GetParam());
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      while (!ring.HasRoom()) {
        std::this_thread::yield();
      }
      ring.Push(Make(i));
    }
  });
  std::uint64_t next = 1;
  bool whole = true;
  bool each_once = true;
  while (next <= kCount) {
    const std::size_t count = ring.Drain(ring.End(), [&](const Story& story) {
      whole = whole && IsWhole(story);
      each_once = each_once && story.number == next;
      ++next;
    });
    if (count == 0) {
      std::this_thread::yield();
    }
  }
  writer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(each_once);
  EXPECT_EQ(ring.dropped(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Sizes, BoundedRingSizeTest, testing::Values(1, 2, 3, 64));

// Values pushed after the mark stay for the next Drain.
TEST(BoundedRingTest, DrainsOnlyUpToTheMark) {
  BoundedRing<int> ring(4);
  ring.Push(1);
  ring.Push(2);
  const std::uint64_t mark = ring.End();
  ring.Push(3);
  int sum = 0;
  const auto add = [&](int value) { sum = 10 * sum + value; };
  EXPECT_EQ(ring.Drain(mark, add), 2U);
  EXPECT_EQ(sum, 12);
  EXPECT_EQ(ring.Drain(ring.End(), add), 1U);
  EXPECT_EQ(sum, 123);
}

}  // namespace
}  // namespace fovea::linux_rt
