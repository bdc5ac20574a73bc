// SPDX-License-Identifier: Apache-2.0
// The image sensor: its noise, gain, vignetting, saturation and mosaic by their laws; the same for the same
// seed and frame.
#include "sim/camera/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

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
  Sensor({.read_sigma = sigma}, seed).Expose(rgba, kWidth, frame, bgr);
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

// One picture of equal pixels.
std::vector<std::uint8_t> ExposeGray(const SensorConfig& config, std::uint8_t level, double gain = 1.0,
                                     std::uint64_t frame = 0) {
  std::vector<std::uint8_t> rgba(std::size_t{4} * kWidth * kHeight, level);
  std::vector<std::uint8_t> bgr(std::size_t{3} * kWidth * kHeight);
  Sensor(config, 1).Expose(rgba, kWidth, frame, bgr, gain);
  return bgr;
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};
Moments MomentsOf(const std::vector<std::uint8_t>& values) {
  Moments m;
  for (const std::uint8_t v : values) {
    m.mean += v / static_cast<double>(values.size());
  }
  for (const std::uint8_t v : values) {
    m.variance += (v - m.mean) * (v - m.mean) / static_cast<double>(values.size());
  }
  return m;
}

// The photon transfer curve: variance a y + b, by least squares over ten levels; each variance of n = 230 400
// values has a relative standard deviation of sqrt(2 / n).
TEST(SensorTest, VarianceIsProportionalToTheLightPlusThatOfTheReadOut) {
  for (const double gain : {1.0, 2.0}) {
    const SensorConfig config{.read_sigma = 2.0, .shot_noise = 0.25, .gain = gain};
    const double a = gain * config.shot_noise;
    const double b = gain * gain * 4.0 + 1.0 / 12.0;  // plus the rounding to whole gray levels
    double sw = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (int level = 20; level <= 110; level += 10) {
      const Moments m = MomentsOf(
          ExposeGray(config, static_cast<std::uint8_t>(level), 1.0, static_cast<std::uint64_t>(level)));
      EXPECT_NEAR(m.mean, gain * level, 0.08) << level;
      const double expected = a * gain * level + b;
      const double w = 1.0 / (expected * expected);
      sw += w;
      sx += w * m.mean;
      sy += w * m.variance;
      sxx += w * m.mean * m.mean;
      sxy += w * m.mean * m.variance;
    }
    const double slope = (sw * sxy - sx * sy) / (sw * sxx - sx * sx);
    const double offset = (sy - slope * sx) / sw;
    const double relative = std::sqrt(2.0 / (3.0 * kWidth * kHeight));
    const double sigma_a = relative * std::sqrt(sw / (sw * sxx - sx * sx));
    const double sigma_b = relative * std::sqrt(sxx / (sw * sxx - sx * sx));
    std::cout << "gain " << gain << ": variance " << slope << " y + " << offset << ", expected " << a
              << " y + " << b << ", standard deviations " << sigma_a << ", " << sigma_b << "\n";
    EXPECT_NEAR(slope, a, 3.0 * sigma_a);
    EXPECT_NEAR(offset, b, 3.0 * sigma_b);
  }
}

TEST(SensorTest, ShotNoiseOfBothNoisesAndRowsIsUncorrelated) {
  const auto picture = ExposeGray({.read_sigma = 3.0, .shot_noise = 0.1}, 100);
  constexpr std::size_t kRow = std::size_t{3} * kWidth;
  double neighbours = 0.0;
  double rows = 0.0;
  const Moments m = MomentsOf(picture);
  for (std::size_t i = 0; i + kRow < picture.size(); ++i) {
    neighbours += (picture[i] - m.mean) * (picture[i + 1] - m.mean);
    rows += (picture[i] - m.mean) * (picture[i + kRow] - m.mean);
  }
  const double n = static_cast<double>(picture.size() - kRow) * m.variance;
  EXPECT_LT(std::fabs(neighbours / n), 0.01);
  EXPECT_LT(std::fabs(rows / n), 0.01);
}

TEST(SensorTest, LightFallsWithTheFourthPowerOfTheCosine) {
  SensorConfig config;
  config.vignetting = MakePinhole(kWidth, kHeight, 1.4);
  const auto picture = ExposeGray(config, 200);
  double worst = 0.0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const Eigen::Vector3d ray((u - config.vignetting->c_u_px) / config.vignetting->f_px,
                                (v - config.vignetting->c_v_px) / config.vignetting->f_px, 1.0);
      const double cosine = ray.normalized().z();
      worst = std::max(worst, std::fabs(picture[static_cast<std::size_t>(3 * (v * kWidth + u))] -
                                        200.0 * std::pow(cosine, 4)));
    }
  }
  std::cout << "off cos^4 by at most " << worst << " gray levels; the corner has " << int{picture[0]}
            << " of 200\n";
  EXPECT_LT(worst, 0.51);  // rounding to whole gray levels
  EXPECT_LT(picture[0], 90) << "too little for this test";
}

// A full pixel collects no more photons: the gain does not bring its light back, and its noise vanishes.
TEST(SensorTest, FullPixelsAreCutBeforeTheGain) {
  const Moments full = MomentsOf(ExposeGray({.shot_noise = 0.5, .gain = 1.5, .saturation = 100.0}, 200));
  EXPECT_NEAR(full.mean, 150.0, 1e-6);
  EXPECT_NEAR(full.variance, 0.0, 1e-6);
  EXPECT_NEAR(MomentsOf(ExposeGray({.gain = 3.0}, 200)).mean, 255.0, 1e-6);
}

TEST(SensorTest, AutomaticExposureMultipliesTheSensorsOwnGain) {
  EXPECT_NEAR(MomentsOf(ExposeGray({.gain = 2.0}, 30, 1.5)).mean, 90.0, 1e-6);
}

// Equal pixels stay equal through a mosaic; at a vertical edge the interpolated colours lie between its
// sides.
TEST(SensorTest, MosaicKeepsEachPixelsOwnColour) {
  const std::size_t red_at[4] = {0, 1, kWidth, kWidth + 1};  // of the 2 x 2 blocks of RG, GR, GB, BG
  std::vector<std::uint8_t> rgba(std::size_t{4} * kWidth * kHeight);
  std::mt19937 engine(1);
  for (std::size_t i = 0; i < rgba.size() / 4; ++i) {
    rgba[4 * i] = static_cast<std::uint8_t>(engine() % 256U);  // red
    rgba[4 * i + 1] = 120;
    rgba[4 * i + 2] = 140;
  }
  std::size_t pattern = 0;
  for (const auto format : {camera::RawFormat::kBayerRg8, camera::RawFormat::kBayerGr8,
                            camera::RawFormat::kBayerGb8, camera::RawFormat::kBayerBg8}) {
    SensorConfig config;
    config.mosaic = format;
    std::vector<std::uint8_t> bgr(std::size_t{3} * kWidth * kHeight);
    Sensor(config, 1).Expose(rgba, kWidth, 0, bgr);
    int own = 0;
    int others = 0;
    for (int v = 2; v + 2 < kHeight; v += 2) {  // the interpolation copies the border
      for (int u = 2; u + 2 < kWidth; u += 2) {
        const std::size_t block = static_cast<std::size_t>(v * kWidth + u);
        for (const std::size_t at : red_at) {
          const std::size_t pixel = block + at;
          EXPECT_NEAR(bgr[3 * pixel + 1], 120, 1);
          EXPECT_NEAR(bgr[3 * pixel], 140, 1);
          const bool same = bgr[3 * pixel + 2] == rgba[4 * pixel];
          (at == red_at[pattern] ? own : others) += same ? 1 : 0;
        }
      }
    }
    const int blocks = (kHeight / 2 - 2) * (kWidth / 2 - 2);
    EXPECT_EQ(own, blocks) << camera::Name(format);
    EXPECT_LT(others, blocks / 10) << camera::Name(format);
    ++pattern;
  }
}

}  // namespace
}  // namespace fovea::sim
