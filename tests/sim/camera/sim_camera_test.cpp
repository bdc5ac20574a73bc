// What the contract does not say of the simulated camera: order under uneven work, loss, a painter that
// fails.
#include "sim/camera/sim_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

// Takes what a closed camera with a queue of 2 still has of `exposed` frames: the newest, and at most one
// more that a painter had in its hands.
void ExpectTheNewestOf(std::uint64_t exposed, SimCamera& camera) {
  std::vector<std::uint64_t> got;
  hal::Frame frame;
  while (camera.Acquire(frame, kLong).ok()) {
    got.push_back(frame.sequence);
  }
  ASSERT_FALSE(got.empty());
  EXPECT_EQ(got.back(), exposed - 1) << "the newest is what a servo needs";
  EXPECT_LE(got.size(), 3U);
  EXPECT_EQ(got.size() + camera.lost(), exposed);
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

// Whether pictures are slow to draw or nobody takes them: two wait, the rest is lost, the newest are kept.
TEST(SimCameraTest, SlowDrawingDropsAndCountsTheOldestFrames) {
  std::latch all_exposed(1);
  const auto draw = [&](const Exposure& exposure, std::span<std::uint8_t> rgba) {
    all_exposed.wait();
    Fill(exposure, rgba);
  };
  SimCamera camera(Small(2), Sensor(0.0, 1), {{draw, {}}});
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
  SimCamera camera(Small(2), Sensor(0.0, 1), {{draw, {}}});
  for (std::uint64_t i = 0; i < 6; ++i) {
    camera.Expose(Numbered(i));
    drawn.acquire();
  }
  camera.Close();
  ExpectTheNewestOf(6, camera);
}

TEST(SimCameraTest, FailingPainterIsADeviceFaultWithItsMessage) {
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
