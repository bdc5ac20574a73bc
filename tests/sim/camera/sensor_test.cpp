// SPDX-License-Identifier: Apache-2.0
// The image sensor: noise with the configured deviation, the same for the same seed and frame.
#include "sim/camera/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace fovea::sim {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

std::vector<std::uint8_t> Expose(double sigma, std::uint64_t seed, std::uint64_t frame) {
  std::vector<std::uint8_t> rgba;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    rgba.insert(rgba.end(), {100, 120, 140, 255});
  }
  std::vector<std::uint8_t> bgr(std::size_t{3} * kWidth * kHeight);
  Sensor(sigma, seed).Expose(rgba, kWidth, frame, bgr);
  return bgr;
}

TEST(SensorTest, NoiseHasZeroMeanAndTheSetDeviation) {
  const std::vector<std::uint8_t> bgr = Expose(7.0, 1, 0);
  double sum = 0.0;
  double sum2 = 0.0;
  const double channel[3] = {140.0, 120.0, 100.0};
  for (std::size_t i = 0; i < bgr.size(); ++i) {
    const double e = bgr[i] - channel[i % 3];
    sum += e;
    sum2 += e * e;
  }
  const auto n = static_cast<double>(bgr.size());
  EXPECT_NEAR(sum / n, 0.0, 0.1);
  EXPECT_NEAR(std::sqrt(sum2 / n), std::sqrt(49.0 + 1.0 / 12.0), 0.1);  // plus the rounding error
}

TEST(SensorTest, ZeroNoiseLeavesPixelsUnchanged) {
  const std::vector<std::uint8_t> bgr = Expose(0.0, 1, 0);
  EXPECT_EQ(bgr[0], 140);
  EXPECT_EQ(bgr[1], 120);
  EXPECT_EQ(bgr[2], 100);
  EXPECT_TRUE(std::equal(bgr.begin() + 3, bgr.end(), bgr.begin()));
}

TEST(SensorTest, NoiseDependsOnSeedAndFrame) {
  const auto first = Expose(3.0, 1, 5);
  EXPECT_EQ(first, Expose(3.0, 1, 5));
  EXPECT_NE(first, Expose(3.0, 2, 5));
  EXPECT_NE(first, Expose(3.0, 1, 6));
}

// Neighbouring rows and frames read one noise table and must not read it at the same place.
TEST(SensorTest, NoiseOfRowsAndFramesIsUncorrelated) {
  const auto a = Expose(7.0, 1, 0);
  const auto b = Expose(7.0, 1, 1);
  const auto correlation = [](const std::uint8_t* p, const std::uint8_t* q, std::size_t count) {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; i += 3) {
      sum += (p[i] - 140.0) * (q[i] - 140.0);
    }
    return sum / (static_cast<double>(count) / 3.0) / 49.0;
  };
  constexpr std::size_t kRow = std::size_t{3} * kWidth;
  EXPECT_LT(std::fabs(correlation(a.data(), b.data(), a.size())), 0.02);
  EXPECT_LT(std::fabs(correlation(a.data(), a.data() + kRow, a.size() - kRow)), 0.02);
}

}  // namespace
}  // namespace fovea::sim
