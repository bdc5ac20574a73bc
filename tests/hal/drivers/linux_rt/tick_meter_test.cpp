// SPDX-License-Identifier: Apache-2.0
#include "fovea/linux_rt/tick_meter.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include "fovea/linux_rt/heap_counter.hpp"

namespace fovea::linux_rt {
namespace {

TEST(DurationHistogramTest, PercentilesAreWithinOneBin) {
  std::mt19937_64 engine(1);
  std::lognormal_distribution<double> durations(8.0, 2.0);
  DurationHistogram histogram;
  std::vector<std::int64_t> all;
  for (int i = 0; i < 20000; ++i) {
    all.push_back(static_cast<std::int64_t>(durations(engine)));
    histogram.Add(all.back());
  }
  std::sort(all.begin(), all.end());
  for (const double p : {0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(all.size()))) - 1;
    const auto exact = static_cast<double>(all[rank]);
    const auto told = static_cast<double>(histogram.Percentile(p));
    EXPECT_GE(told, exact) << p;
    EXPECT_LE(told, exact * (1.0 + 1.0 / 64.0) + 1.0) << p;
  }
  EXPECT_EQ(histogram.max_ns(), all.back());
  EXPECT_EQ(histogram.count(), all.size());
}

TEST(DurationHistogramTest, AcceptsNegativeAndHugeDurations) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.Percentile(0.5), 0);
  for (const std::int64_t d : {std::int64_t{-5}, std::int64_t{0}, std::int64_t{1}, INT64_MAX}) {
    histogram.Add(d);
  }
  EXPECT_EQ(histogram.count(), 4U);
  EXPECT_EQ(histogram.Percentile(1.0), INT64_MAX);
  EXPECT_EQ(histogram.Percentile(0.25), 0);
}

TEST(RecentDurationsTest, SummarizesWhatCameSinceTheLastCall) {
  RecentDurations recent;
  EXPECT_FALSE(recent.TakeNew());
  for (const std::int64_t d : {30, 10, 20}) {
    recent.Add(d);
  }
  const auto three = recent.TakeNew();
  ASSERT_TRUE(three);
  EXPECT_EQ(three->median_ns, 20);
  EXPECT_EQ(three->max_ns, 30);
  EXPECT_FALSE(recent.TakeNew());
  recent.Add(5);
  EXPECT_EQ(recent.TakeNew()->max_ns, 5);
}

TEST(RecentDurationsTest, KeepsTheNewestOfMany) {
  RecentDurations recent;
  for (std::int64_t d = 1; d <= 10'000; ++d) {
    recent.Add(d);
  }
  const auto last = recent.TakeNew();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->max_ns, 10'000);
  EXPECT_GT(last->median_ns, 9'000);
}

TEST(TickMeterTest, CountsHeapCallsOfTheTickOnly) {
#ifdef FOVEA_SANITIZED
  GTEST_SKIP() << "a sanitizer replaces malloc";
#endif
  ASSERT_TRUE(HeapCounterActive());
  TickMeter meter;
  meter.Enter();
  meter.Leave();
  EXPECT_EQ(meter.heap_calls(), 0U);
  meter.Enter();
  void* volatile block = std::malloc(10);
  std::free(block);
  meter.Leave();
  void* volatile outside = std::malloc(10);
  std::free(outside);
  EXPECT_EQ(meter.heap_calls(), 2U);
  EXPECT_EQ(meter.durations().count(), 2U);
}

TEST(TickMeterTest, CountsPageFaultsOfTheTickOnly) {
  constexpr std::size_t kPages = 16;
  constexpr std::size_t kPage = 4096;
  TickMeter meter;
  meter.Enter();
  meter.Leave();
  void* fresh = mmap(nullptr, kPages * kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(fresh, MAP_FAILED);
  const std::uint64_t before = meter.page_faults();
  meter.Enter();
  for (std::size_t i = 0; i < kPages; ++i) {
    static_cast<volatile char*>(fresh)[i * kPage] = 1;
  }
  meter.Leave();
  munmap(fresh, kPages * kPage);
  EXPECT_GE(meter.page_faults() - before, 1U);  // at least one, since the kernel may map several at once
}

}  // namespace
}  // namespace fovea::linux_rt
