// SPDX-License-Identifier: Apache-2.0
// The benchmarks' statistics compared with closed-form results.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <thread>

#include "tools/bench/common/spread.hpp"
#include "tools/bench/jitter/cyclictest.hpp"

namespace fovea::bench {
namespace {

constexpr double kNormal90 = 1.6449;  // half of a normal variable's 90 % interval, in deviations

// n values: the medians of n equally likely parts of an exponential distribution with mean 1.
std::vector<double> ExponentialGrid(int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) {
    values.push_back(-std::log((i + 0.5) / n));
  }
  return values;
}

std::vector<std::vector<double>> ExponentialBlocks(int blocks, int size, double mean, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::exponential_distribution<double> exponential(1.0 / mean);
  std::vector<std::vector<double>> list(static_cast<std::size_t>(blocks));
  for (std::vector<double>& block : list) {
    for (int i = 0; i < size; ++i) {
      block.push_back(exponential(engine));
    }
  }
  return list;
}

TEST(BenchStatistics, PercentilesMatchAnExponential) {
  const std::vector<double> values = ExponentialGrid(1'000'000);
  for (const double p : {0.5, 0.99, 0.999, 0.9999}) {
    const double exact = -std::log(1.0 - p);
    EXPECT_NEAR(Percentile(values, p), exact, 0.01 * exact) << p;
  }
  EXPECT_EQ(Percentile({3.0, 1.0, 2.0}, 0.0), 1.0);
  EXPECT_EQ(Percentile({3.0, 1.0, 2.0}, 1.0), 3.0);
  EXPECT_EQ(Percentile({}, 0.5), 0.0);
}

TEST(BenchStatistics, EveryRoundCallsWithEveryCaseOnce) {
  std::vector<int> calls(7, 0);
  MedianNs(5, calls, [](int& count) { ++count; });
  EXPECT_EQ(calls, std::vector<int>(7, 5));
}

TEST(BenchStatistics, MeanDurationIsPerCase) {
  const std::vector<int> cases(2);
  const double ns = MeanNs(cases, [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
  EXPECT_GE(ns, 1e6);
}

// The sample percentile p of an exponential has the deviation sqrt(p / (1 - p) / n); its logarithm has that
// divided by the percentile. The two samples are independent.
TEST(BenchStatistics, IntervalWidthMatchesTheory) {
  constexpr int kBlocks = 200;
  constexpr int kSize = 100;
  constexpr double p = 0.9;
  const double percentile = -std::log(1.0 - p);
  const double deviation = std::sqrt(2.0 * p / (1.0 - p) / (kBlocks * kSize)) / percentile;
  double width = 0.0;
  int holds = 0;
  constexpr unsigned kTimes = 60;
  for (unsigned k = 0; k < kTimes; ++k) {
    const Ratio ratio = RatioOfPercentiles(ExponentialBlocks(kBlocks, kSize, 3.0, 2 * k + 1),
                                           ExponentialBlocks(kBlocks, kSize, 2.0, 2 * k + 2), p, k + 1);
    width += std::log(ratio.high / ratio.low) / kTimes;
    holds += ratio.low <= 1.5 && 1.5 <= ratio.high ? 1 : 0;
    EXPECT_LE(ratio.low, ratio.value);
    EXPECT_GE(ratio.high, ratio.value);
  }
  EXPECT_NEAR(width / (2.0 * kNormal90 * deviation), 1.0, 0.1);
  // 54 of 60 are expected, with a deviation of 2.3.
  EXPECT_GE(holds, 46);
  EXPECT_LE(holds, 60);
}

// A disturbance of both kinds in the same block is no difference between them.
TEST(BenchStatistics, DisturbedPairsCancel) {
  std::vector<std::vector<double>> blocks = ExponentialBlocks(20, 100, 1.0, 1);
  for (double& value : blocks[7]) {
    value *= 1000.0;
  }
  const Ratio same = RatioOfPercentiles(blocks, blocks, 0.999);
  EXPECT_EQ(same.value, 1.0);
  EXPECT_EQ(same.low, 1.0);
  EXPECT_EQ(same.high, 1.0);
}

TEST(BenchStatistics, RatioOfEmptySamplesIsZero) {
  EXPECT_EQ(RatioOfPercentiles({}, {{1.0}}, 0.5).value, 0.0);
  EXPECT_EQ(RatioOfPercentiles({{1.0}}, {{0.0}}, 0.5).value, 0.0);
  // A block without a partner does not count.
  EXPECT_EQ(RatioOfPercentiles({{4.0}, {100.0}}, {{2.0}}, 0.5).value, 2.0);
}

TEST(BenchStatistics, HistogramCountsEveryValueOnce) {
  const std::vector<double> values{0.3, 1.0, 1.1, 7.9, 8.0, 1000.0};
  const LogHistogram histogram = CountByLog(values);
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < histogram.bins.size(); ++i) {
    const LogHistogram::Bin& bin = histogram.bins[i];
    std::int64_t within = 0;
    for (const double value : values) {
      within += value >= bin.low && value < bin.high ? 1 : 0;
    }
    EXPECT_EQ(bin.count, within) << bin.low;
    EXPECT_TRUE(i == 0 || bin.low == histogram.bins[i - 1].high) << bin.low;
    sum += bin.count;
  }
  EXPECT_EQ(sum, static_cast<std::int64_t>(values.size()));
  EXPECT_TRUE(CountByLog({}).bins.empty());
}

TEST(BenchStatistics, ReadsTheOutputOfCyclictest) {
  const auto us = ReadCyclictest(
      R"({"num_threads": 1, "thread": {"0": {"histogram": {"18": 2, "111": 1}, "cycles": 3, "min": 18}}})");
  ASSERT_TRUE(us.has_value());
  std::vector<double> sorted = *us;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, (std::vector<double>{18.5, 18.5, 111.5}));
  for (const char* text : {"", "{}", "[1]", R"({"thread": {"0": {"histogram": {}}}})",
                           R"({"thread": {"0": {"histogram": {"x": 1}}}})"}) {
    EXPECT_FALSE(ReadCyclictest(text).has_value()) << text;
  }
}

}  // namespace
}  // namespace fovea::bench
