// SPDX-License-Identifier: Apache-2.0
// Requirements for every camera driver. A fixture has `hal::Camera& camera()`, `void Expose(std::int64_t
// stamp_ns)`, which takes one picture, and `void Close()`.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "fovea/hal/camera.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::test {

template <typename Fixture>
class CameraContract : public testing::Test {
 protected:
  static constexpr std::int64_t kPatience = 20 * hal::kNsPerSecond;
  Fixture fixture_;
};

TYPED_TEST_SUITE_P(CameraContract);

TYPED_TEST_P(CameraContract, FramesComeInOrderEachOnceWithTheirStamps) {
  constexpr int kFrames = 5;
  std::uint64_t last_sequence = 0;
  for (int i = 0; i < kFrames; ++i) {
    this->fixture_.Expose(i * hal::kNsPerMs);
    hal::Frame frame;
    ASSERT_TRUE(this->fixture_.camera().Acquire(frame, this->kPatience).ok());
    EXPECT_EQ(frame.stamp_ns, i * hal::kNsPerMs);
    EXPECT_GT(frame.exposure_ns, 0);
    if (i > 0) {
      EXPECT_EQ(frame.sequence, last_sequence + 1);
    }
    last_sequence = frame.sequence;
  }
  hal::Frame frame;
  EXPECT_EQ(this->fixture_.camera().Acquire(frame, 0).code(), hal::StatusCode::kTimeout);
}

TYPED_TEST_P(CameraContract, PixelsStayUntilTheNextAcquire) {
  this->fixture_.Expose(0);
  hal::Frame frame;
  ASSERT_TRUE(this->fixture_.camera().Acquire(frame, this->kPatience).ok());
  const std::vector<std::uint8_t> before(frame.pixels.begin(), frame.pixels.end());
  this->fixture_.Expose(hal::kNsPerMs);
  this->fixture_.Expose(2 * hal::kNsPerMs);
  // Long enough for a driver that works ahead to overwrite a buffer that it no longer owns.
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_TRUE(std::equal(before.begin(), before.end(), frame.pixels.begin()));
}

TYPED_TEST_P(CameraContract, TimesOutWithoutAPicture) {
  hal::Frame frame;
  frame.sequence = 77;
  EXPECT_EQ(this->fixture_.camera().Acquire(frame, hal::kNsPerMs).code(), hal::StatusCode::kTimeout);
  EXPECT_EQ(frame.sequence, 77U);
}

TYPED_TEST_P(CameraContract, ClosesAfterTheLastFrame) {
  this->fixture_.Expose(0);
  this->fixture_.Close();
  hal::Frame frame;
  EXPECT_TRUE(this->fixture_.camera().Acquire(frame, this->kPatience).ok());
  EXPECT_EQ(this->fixture_.camera().Acquire(frame, this->kPatience).code(), hal::StatusCode::kClosed);
  EXPECT_EQ(this->fixture_.camera().Acquire(frame, 0).code(), hal::StatusCode::kClosed);
}

REGISTER_TYPED_TEST_SUITE_P(CameraContract, FramesComeInOrderEachOnceWithTheirStamps,
                            PixelsStayUntilTheNextAcquire, TimesOutWithoutAPicture, ClosesAfterTheLastFrame);

}  // namespace fovea::test
