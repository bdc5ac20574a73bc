// SPDX-License-Identifier: Apache-2.0
// The heap counter counts every allocation function, and reports when it is inactive.
#include "fovea/linux_rt/heap_counter.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

namespace fovea::linux_rt {
namespace {

template <typename Function>
std::uint64_t CallsIn(Function&& function) {
  const std::uint64_t before = CountedHeapCalls();
  EnterCountedRegion();
  function();
  LeaveCountedRegion();
  return CountedHeapCalls() - before;
}

class HeapCounterTest : public testing::Test {
 protected:
  void SetUp() override {
#ifdef FOVEA_SANITIZED
    GTEST_SKIP() << "a sanitizer replaces malloc";
#endif
    ASSERT_TRUE(HeapCounterActive()) << "the interposer is not linked: the tests below would prove nothing";
  }
  // Through a volatile pointer, so that the compiler does not remove the pair of calls.
  static void Use(void* block) {
    void* volatile used = block;
    std::free(used);
  }
  static void Look(const void* block) {
    const void* volatile seen = block;
    static_cast<void>(seen);
  }
};

TEST_F(HeapCounterTest, CountsEveryAllocationFunction) {
  EXPECT_EQ(CallsIn([] { Use(std::malloc(10)); }), 2U);
  EXPECT_EQ(CallsIn([] { Use(std::calloc(2, 10)); }), 2U);
  EXPECT_EQ(CallsIn([] { Use(std::realloc(nullptr, 10)); }), 2U);
  EXPECT_EQ(CallsIn([] { Use(std::aligned_alloc(64, 64)); }), 2U);
  EXPECT_EQ(CallsIn([] {
              void* block = nullptr;
              ASSERT_EQ(posix_memalign(&block, 64, 100), 0);
              Use(block);
            }),
            2U);
  EXPECT_EQ(CallsIn([] { Look(std::vector<double>(100).data()); }), 2U);
  EXPECT_EQ(CallsIn([] {
              int* volatile number = new int(3);
              delete number;
            }),
            2U);
  EXPECT_GE(CallsIn([] { Look(std::string(100, 'x').data()); }), 2U);
}

TEST_F(HeapCounterTest, IgnoresCallsOutsideTheRegionAndInOtherThreads) {
  const std::uint64_t before = CountedHeapCalls();
  Use(std::malloc(10));
  EXPECT_EQ(CountedHeapCalls(), before);
  std::uint64_t other = 1;
  EXPECT_EQ(CallsIn([&] {
              static std::atomic<int> value{0};
              value.fetch_add(1);
            }),
            0U);
  std::thread thread([&] { other = CallsIn([] { Use(std::malloc(1)); }); });
  thread.join();
  EXPECT_EQ(other, 2U);
  EXPECT_EQ(CountedHeapCalls(), before);
}

TEST_F(HeapCounterTest, BadAlignmentIsRefusedAsInTheStandard) {
  void* block = nullptr;
  EXPECT_EQ(posix_memalign(&block, 3, 10), EINVAL);
  EXPECT_EQ(block, nullptr);
}

}  // namespace
}  // namespace fovea::linux_rt
