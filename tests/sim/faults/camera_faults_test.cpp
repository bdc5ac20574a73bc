// SPDX-License-Identifier: Apache-2.0
// Camera faults that show an old scene, old pixels, a mirrored picture, or a wrong stamp.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/camera/sim_camera.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/faults/picture_faults.hpp"

namespace fovea::sim {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kLong = 10'000'000'000;
constexpr double kNoise = 8.0;

// Frame k, exposed at 10 k ms; its target is at x = k.
Exposure FrameAfter(int k) {
  Exposure exposure;
  exposure.sequence = static_cast<std::uint64_t>(k);
  exposure.stamp_ns = 10 * k * kMs;
  exposure.p_BO.x() = k;
  return exposure;
}

std::vector<Exposure> TakeAll(const FrameFaults& faults, int frames) {
  FrameSpoiler spoiler(faults);
  std::vector<Exposure> taken;
  for (int k = 0; k < frames; ++k) {
    const std::optional<Exposure> exposure = spoiler.Spoil(FrameAfter(k));
    if (exposure) {
      taken.push_back(*exposure);
      EXPECT_EQ(taken.back().sequence, static_cast<std::uint64_t>(k)) << "the frame has a new number";
      EXPECT_EQ(taken.back().stamp_ns, 10 * k * kMs);
    }
  }
  return taken;
}

// The frames' pixels as the camera outputs them: the scene's gray level plus sensor noise.
std::vector<std::vector<std::uint8_t>> PixelsOf(const std::vector<Exposure>& taken,
                                                const AutoExposureConfig& auto_exposure = {}) {
  const auto draw = [](const Exposure& exposure, std::span<std::uint8_t> rgba) {
    std::fill(rgba.begin(), rgba.end(), static_cast<std::uint8_t>(100.0 + exposure.p_BO.x()));
  };
  SimCamera camera(
      {.width_px = 64, .height_px = 48, .exposure_ns = 1000, .queue = 100, .auto_exposure = auto_exposure},
      Sensor({.read_sigma = kNoise}, 1), {{draw, {}}});
  std::vector<std::vector<std::uint8_t>> pictures;
  for (const Exposure& exposure : taken) {
    camera.Expose(exposure);
    hal::Frame frame;
    EXPECT_TRUE(camera.Acquire(frame, kLong).ok());
    EXPECT_EQ(frame.stamp_ns, exposure.stamp_ns + exposure.stamp_error_ns);
    pictures.emplace_back(frame.pixels.begin(), frame.pixels.end());
  }
  return pictures;
}

TEST(FrozenPictureTest, FrozenSceneHasFreshNoiseUnlessPixelsFreezeToo) {
  for (const bool pixels : {false, true}) {
    FrameFaults faults;
    faults.freeze = {0.050, 0.100};
    faults.freeze_pixels = pixels;
    const std::vector<Exposure> taken = TakeAll(faults, 15);
    const auto pictures = PixelsOf(taken);
    for (std::size_t k = 0; k < 15; ++k) {
      const bool frozen = k >= 5 && k < 10;
      EXPECT_EQ(taken[k].p_BO.x(), frozen ? 5.0 : static_cast<double>(k));
      if (k != 5) {
        EXPECT_EQ(pictures[k] == pictures[5], frozen && pixels) << "picture " << k;
      }
    }
  }
}

// Frozen pixels keep their gain, although the automatic exposure is not yet at its level.
TEST(FrozenPictureTest, FrozenPixelsStayEqualWithAutomaticExposure) {
  for (const bool pixels : {false, true}) {
    FrameFaults faults;
    faults.freeze = {0.050, 0.100};
    faults.freeze_pixels = pixels;
    const std::vector<Exposure> taken = TakeAll(faults, 15);
    const auto pictures = PixelsOf(taken, {.level = 200.0, .lag_s = 0.1});
    for (std::size_t k = 0; k < 15; ++k) {
      if (k != 5) {
        EXPECT_EQ(pictures[k] == pictures[5], k > 5 && k < 10 && pixels) << "picture " << k;
      }
    }
  }
}

// An object that comes in front of the lens after the freeze is not in the picture.
TEST(FrozenPictureTest, FrozenPixelsKeepTheOcclusionOfThatMoment) {
  FrameFaults faults;
  faults.freeze = {0.050, 0.100};
  faults.freeze_pixels = true;
  const std::vector<Exposure> taken = TakeAll(faults, 12);
  EXPECT_FALSE(taken[4].pixels_of);
  ASSERT_TRUE(taken[9].pixels_of);
  EXPECT_EQ(taken[9].pixels_of->sequence, 5U);
  EXPECT_EQ(taken[9].pixels_of->stamp_ns, 50 * kMs);
  EXPECT_FALSE(taken[10].pixels_of);
}

TEST(ReplayFaultTest, ShowsTheSceneOfTheSetTimeAgo) {
  FrameFaults faults;
  faults.replay = {{0.100, 0.200}, 35 * kMs};
  const std::vector<Exposure> taken = TakeAll(faults, 30);
  for (int k = 0; k < 30; ++k) {
    // The newest scene that is at least 35 ms old: four frames back.
    EXPECT_EQ(taken[static_cast<std::size_t>(k)].p_BO.x(), k >= 10 && k < 20 ? k - 4 : k);
  }
}

TEST(ReplayFaultTest, ShowsTheFirstSceneWhenNoneIsOldEnough) {
  FrameFaults faults;
  faults.replay = {{0.0, 0.100}, 50 * kMs};
  const std::vector<Exposure> taken = TakeAll(faults, 12);
  for (int k = 0; k < 12; ++k) {
    EXPECT_EQ(taken[static_cast<std::size_t>(k)].p_BO.x(), k >= 10 ? k : std::max(k - 5, 0));
  }
}

TEST(StampFaultTest, ShiftsOnlyTheStampOfTheFrame) {
  for (const std::int64_t by_ns : {-60 * kMs, 8 * kMs}) {
    FrameFaults faults;
    faults.stamp = {{0.050, 0.100}, by_ns};
    const std::vector<Exposure> taken = TakeAll(faults, 15);  // stamp_ns is still the time of exposure
    for (int k = 0; k < 15; ++k) {
      const Exposure& exposure = taken[static_cast<std::size_t>(k)];
      EXPECT_EQ(exposure.stamp_error_ns, k >= 5 && k < 10 ? by_ns : 0);
      EXPECT_EQ(exposure.p_BO.x(), k);
    }
    PixelsOf(taken);  // checks the frames' stamps
    EXPECT_EQ(FrameSpoiler(faults).DelayNs(70 * kMs), 0) << "the frames are not delayed";
  }
}

TEST(MirrorTest, SwapsLeftAndRightWithinItsWindow) {
  constexpr int kWidth = 5;
  constexpr int kHeight = 2;
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(4 * kWidth * kHeight));
  for (std::size_t i = 0; i < picture.size(); ++i) {
    picture[i] = static_cast<std::uint8_t>(i);
  }
  PictureFaults faults;
  faults.mirror = {1.0, 2.0};
  std::vector<std::uint8_t> rgba = picture;
  SpoilPicture(faults, 500 * kMs, kWidth, rgba);
  EXPECT_EQ(rgba, picture);
  SpoilPicture(faults, 1500 * kMs, kWidth, rgba);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      for (int channel = 0; channel < 4; ++channel) {
        const auto at = [&](int column) {
          return static_cast<std::size_t>(4 * (v * kWidth + column) + channel);
        };
        EXPECT_EQ(rgba[at(u)], picture[at(kWidth - 1 - u)]);
      }
    }
  }
}

// A glare at the left of the lens appears at the right of a mirrored picture.
TEST(MirrorTest, MirrorsGlareOnTheLensToo) {
  constexpr int kWidth = 64;
  PictureFaults faults;
  faults.mirror = {0.0, 1.0};
  faults.glare = {{0.0, 1.0}, 10.0, 24.0, 5.0};
  std::vector<std::uint8_t> rgba(static_cast<std::size_t>(4 * kWidth * 48), 100);
  SpoilPicture(faults, 0, kWidth, rgba);
  const auto at = [&](int u) { return rgba[static_cast<std::size_t>(4 * (24 * kWidth + u))]; };
  EXPECT_EQ(at(10), 100);
  EXPECT_EQ(at(kWidth - 1 - 10), 255);
}

}  // namespace
}  // namespace fovea::sim
