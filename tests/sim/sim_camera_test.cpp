// What the contract does not say of the simulated camera: order under uneven work, loss, a painter that
// fails.
#include "sim/camera/sim_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <latch>
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

TEST(SimCameraTest, FramesKeepTheirOrderWhenALaterPictureIsReadyFirst) {
  std::latch third_is_drawn(1);
  const auto draw = [&](const Exposure& exposure, std::span<std::uint8_t> rgba) {
    if (exposure.sequence == 0) {
      third_is_drawn.wait();  // the other painter is two pictures ahead by then
    }
    Fill(exposure, rgba);
    if (exposure.sequence == 2) {
      third_is_drawn.count_down();
    }
  };
  SimCamera camera(Small(8), Sensor(0.0, 1), {{draw, {}}, {draw, {}}});
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

TEST(SimCameraTest, LosesTheOldestAndCountsItWhenNobodyTakesThem) {
  SimCamera camera(Small(2), Sensor(0.0, 1), {{Fill, {}}});
  for (std::uint64_t i = 0; i < 6; ++i) {
    camera.Expose(Numbered(i));
  }
  camera.Close();
  std::uint64_t got = 0;
  std::uint64_t last = 0;
  hal::Frame frame;
  while (camera.Acquire(frame, kLong).ok()) {
    ++got;
    last = frame.sequence;
  }
  EXPECT_EQ(last, 5U) << "the newest is what a servo needs";
  EXPECT_LT(got, 6U);
  EXPECT_EQ(got + camera.lost(), 6U);
}

TEST(SimCameraTest, APainterThatFailsIsADeviceFaultWithItsWords) {
  const auto fail = [](const Exposure&, std::span<std::uint8_t>) {
    throw std::runtime_error("the driver is gone");
  };
  SimCamera camera(Small(2), Sensor(0.0, 1), {{fail, {}}});
  camera.Expose(Numbered(0));
  hal::Frame frame;
  EXPECT_EQ(camera.Acquire(frame, kLong).code(), hal::StatusCode::kDeviceFault);
  EXPECT_EQ(camera.fault(), "the driver is gone");
}

}  // namespace
}  // namespace fovea::sim
