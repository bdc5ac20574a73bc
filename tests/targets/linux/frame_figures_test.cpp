// SPDX-License-Identifier: Apache-2.0
// Figures of frames with known times.
#include "firmware/targets/linux/frame_figures.hpp"

#include <gtest/gtest.h>

namespace fovea::hw {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(FrameFiguresTest, FewerThanTwoFramesHaveZeroRate) {
  EXPECT_EQ(FiguresOf({}).rate_hz, 0.0);
  EXPECT_EQ(FiguresOf({{0, 40 * kMs}}).rate_hz, 0.0);
}

TEST(FrameFiguresTest, RateComesFromStampsIncludingGaps) {
  std::vector<Arrival> arrivals;
  for (const std::int64_t k : {0, 1, 2, 3, 5, 6, 7, 8, 9, 10}) {  // one is lost
    arrivals.push_back({k * 20 * kMs, (k * 20 + 30 + k % 2) * kMs});
  }
  const FrameFigures figures = FiguresOf(arrivals);
  EXPECT_DOUBLE_EQ(figures.rate_hz, 45.0);
  EXPECT_DOUBLE_EQ(figures.period_ms, 20.0);
  EXPECT_EQ(figures.late, 0);
}

TEST(FrameFiguresTest, FrameIsLateHalfAPeriodBeyondTheUsualLatency) {
  std::vector<Arrival> arrivals;
  for (std::int64_t k = 0; k < 20; ++k) {
    const std::int64_t more_ms = k == 7 ? 11 : k == 12 ? 9 : k == 15 ? 55 : 0;
    arrivals.push_back({k * 20 * kMs, (k * 20 + 40 + more_ms) * kMs});
  }
  const FrameFigures figures = FiguresOf(arrivals);
  EXPECT_DOUBLE_EQ(figures.latency_ms, 40.0);
  EXPECT_DOUBLE_EQ(figures.latency_max_ms, 95.0);
  EXPECT_EQ(figures.late, 2);
}

}  // namespace
}  // namespace fovea::hw
