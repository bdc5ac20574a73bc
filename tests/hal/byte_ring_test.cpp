// SPDX-License-Identifier: Apache-2.0
// The ring between a board's interrupt and its main program, tested here with two threads.
// tests/models/byte_ring.pml checks the same for every order of the steps, also when the counters wrap.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "fovea/cortex_m7/byte_ring.hpp"

namespace fovea::cortex_m7 {
namespace {

TEST(ByteRingTest, RefusesAByteWithoutRoom) {
  ByteRing<4> ring;
  EXPECT_TRUE(ring.Empty());
  for (std::uint8_t i = 0; i < 4; ++i) {
    EXPECT_EQ(ring.Room(), 4U - i);
    EXPECT_TRUE(ring.Put(i));
  }
  EXPECT_FALSE(ring.Put(9));
  std::uint8_t byte = 77;
  for (std::uint8_t i = 0; i < 4; ++i) {
    EXPECT_FALSE(ring.Empty());
    ASSERT_TRUE(ring.Take(byte));
    EXPECT_EQ(byte, i);
  }
  EXPECT_FALSE(ring.Take(byte));
  EXPECT_EQ(byte, 3);  // untouched
}

TEST(ByteRingTest, TwoThreadsTakeOrRefuseEveryByte) {
  constexpr std::uint32_t kCount = 300'000;
  ByteRing<16> ring;
  std::atomic<bool> done{false};
  std::uint32_t refused = 0;
  std::uint32_t broken = 0;
  std::thread writer([&] {
    std::uint8_t next = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      const bool has_room = ring.Room() > 0;
      if (ring.Put(next)) {
        ++next;  // so that a lost, doubled or misplaced byte is detected
      } else {
        ++refused;
        broken += has_room ? 1U : 0U;
        std::this_thread::yield();
      }
    }
    done = true;
  });
  std::uint32_t taken = 0;
  bool in_order = true;
  bool empty_is_true = true;
  std::uint8_t expected = 0;
  const auto take = [&] {
    const bool empty = ring.Empty();
    std::uint8_t byte = 0;
    if (!ring.Take(byte)) {
      empty_is_true = empty_is_true && empty;
      return false;
    }
    in_order = in_order && byte == expected;
    ++expected;
    ++taken;
    return true;
  };
  while (!done) {
    if (!take()) {
      std::this_thread::yield();
    }
  }
  writer.join();
  while (take()) {
  }
  EXPECT_TRUE(in_order);
  EXPECT_TRUE(empty_is_true);
  EXPECT_EQ(broken, 0U) << "a byte was refused although there was room";
  EXPECT_EQ(taken + refused, kCount);
  EXPECT_GT(taken, 0U);
}

}  // namespace
}  // namespace fovea::cortex_m7
