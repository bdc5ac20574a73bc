// SPDX-License-Identifier: Apache-2.0
// Properties of the simulated camera beyond the contract: order of frames, loss, and a failing painter.
#include "sim/camera/sim_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <latch>
#include <semaphore>
#include <stdexcept>

namespace fovea::sim {
namespace {

constexpr std::int64_t kLong = 10'000'000'000;

SimCameraConfig Small(std::size_t queue) {
  return {.width_px = 64, .height_px = 48, .exposure_ns = 1000, .queue = queue};
}

Exposure Numbered(std::uint64_t sequence) {
  Exposure exposure;
  exposure.sequence = sequence;
  exposure.stamp_ns = static_cast<std::int64_t>(1000 * (sequence + 1));
  return exposure;
}

void Fill(const Exposure& exposure, std::span<std::uint8_t> rgba) {
  std::fill(rgba.begin(), rgba.end(), static_cast<std::uint8_t>(exposure.sequence));
}

// Takes the remaining frames of a closed camera with a queue of 2, after `exposed` frames: the newest, and at
// most one more that a painter was drawing.
void ExpectTheNewestOf(std::uint64_t exposed, SimCamera& camera) {
  std::vector<std::uint64_t> got;
  hal::Frame frame;
  while (camera.Acquire(frame, kLong).ok()) {
    got.push_back(frame.sequence);
  }
  ASSERT_FALSE(got.empty());
  EXPECT_EQ(got.back(), exposed - 1) << "a servo needs the newest";
  EXPECT_LE(got.size(), 3U);
  EXPECT_EQ(got.size() + camera.lost(), exposed);
}

TEST(SimCameraTest, FramesKeepTheirOrderWhenALaterPictureIsReadyFirst) {
  std::latch third_is_drawn(1);
  const auto draw = [&](const Exposure& exposure, std::span<std::uint8_t> rgba) {
    if (exposure.sequence == 0) {
      third_is_drawn.wait();  // then the other painter is two pictures ahead
    }
    Fill(exposure, rgba);
    if (exposure.sequence == 2) {
      third_is_drawn.count_down();
    }
  };
  SimCamera camera(Small(8), Sensor({.read_sigma = 0.0}, 1), {{draw, {}}, {draw, {}}});
  for (std::uint64_t i = 0; i < 4; ++i) {
    camera.Expose(Numbered(i));
  }
  for (std::uint64_t i = 0; i < 4; ++i) {
    hal::Frame frame;
    ASSERT_TRUE(camera.Acquire(frame, kLong).ok());
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.pixels.front(), i);
  }
}

// If drawing is slow or frames are not taken, two frames wait, the newest are kept and the rest is lost.
TEST(SimCameraTest, SlowDrawingDropsAndCountsTheOldestFrames) {
  std::latch all_exposed(1);
  const auto draw = [&](const Exposure& exposure, std::span<std::uint8_t> rgba) {
    all_exposed.wait();
    Fill(exposure, rgba);
  };
  SimCamera camera(Small(2), Sensor({.read_sigma = 0.0}, 1), {{draw, {}}});
  for (std::uint64_t i = 0; i < 6; ++i) {
    camera.Expose(Numbered(i));
  }
  all_exposed.count_down();
  camera.Close();
  ExpectTheNewestOf(6, camera);
}

TEST(SimCameraTest, UntakenFramesDropAndCountTheOldest) {
  std::counting_semaphore<> drawn(0);
  const auto draw = [&](const Exposure& exposure, std::span<std::uint8_t> rgba) {
    Fill(exposure, rgba);
    drawn.release();
  };
  SimCamera camera(Small(2), Sensor({.read_sigma = 0.0}, 1), {{draw, {}}});
  for (std::uint64_t i = 0; i < 6; ++i) {
    camera.Expose(Numbered(i));
    drawn.acquire();
  }
  camera.Close();
  ExpectTheNewestOf(6, camera);
}

// What the exposure measures is what the sensor outputs: pixels that the lens darkens, and full ones.
TEST(SimCameraTest, AutomaticExposureReachesItsLevelThroughVignettingAndSaturation) {
  constexpr double kLevel = 110.0;
  SimCameraConfig config = Small(4);
  config.auto_exposure = {.level = kLevel, .lag_s = 0.02, .gain_max = 16.0};
  SensorConfig sensor;
  sensor.vignetting = MakePinhole(64, 48, 1.4);
  sensor.saturation = 80.0;
  const auto draw = [](const Exposure&, std::span<std::uint8_t> rgba) {
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      rgba[i] = i < rgba.size() / 4 ? 200 : 60;  // a quarter of the picture is full
    }
  };
  SimCamera camera(config, Sensor(sensor, 1), {{draw, {}}, {draw, {}}});
  double mean = 0.0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    Exposure exposure = Numbered(i);
    exposure.stamp_ns = static_cast<std::int64_t>(10'000'000 * i);
    camera.Expose(exposure);
    hal::Frame frame;
    ASSERT_TRUE(camera.Acquire(frame, kLong).ok());
    mean = MeanOf(frame.pixels);
  }
  std::cout << "mean of the last picture " << mean << ", wanted " << kLevel << "\n";
  EXPECT_NEAR(mean, kLevel, 0.5);  // the rounding of its pixels
}

TEST(SimCameraTest, FailingPainterIsADeviceFaultWithItsMessage) {
  const auto fail = [](const Exposure&, std::span<std::uint8_t>) {
    throw std::runtime_error("the driver is gone");
  };
  SimCamera camera(Small(2), Sensor({.read_sigma = 0.0}, 1), {{fail, {}}});
  camera.Expose(Numbered(0));
  hal::Frame frame;
  EXPECT_EQ(camera.Acquire(frame, kLong).code(), hal::StatusCode::kDeviceFault);
  EXPECT_EQ(camera.fault(), "the driver is gone");
}

}  // namespace
}  // namespace fovea::sim
