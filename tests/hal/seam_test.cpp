// SPDX-License-Identifier: Apache-2.0
// Promises of the seam's base classes for every driver: arguments and results
// are checked, and an error leaves the outputs unchanged.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "fovea/hal/events.hpp"
#include "tests/support/fake_drivers.hpp"

namespace fovea::hal {
namespace {

TEST(ArmTest, RefusesAnotherNumberOfJoints) {
  test::FakeArm arm(7);
  ArmCommand command;
  command.num_joints = 6;
  EXPECT_EQ(arm.Write(command).code(), StatusCode::kInvalidArgument);
  EXPECT_TRUE(arm.written.empty());
}

TEST(ArmTest, RefusesANonFiniteTorque) {
  test::FakeArm arm(7);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    ArmCommand command;
    command.num_joints = 7;
    command.tau_cmd[3] = bad;
    const Status status = arm.Write(command);
    EXPECT_EQ(status.code(), StatusCode::kNonFinite);
    EXPECT_STREQ(status.where(), "ArmCommand.tau_cmd");
  }
  EXPECT_TRUE(arm.written.empty());
}

TEST(ArmTest, PassesNonFiniteReadingsOn) {
  test::FakeArm arm(7);
  arm.state.q[2] = std::nan("");
  ArmState state;
  EXPECT_TRUE(arm.Read(state).ok());
  EXPECT_TRUE(std::isnan(state.q[2]));
}

TEST(ArmTest, KeepsTheStateOnAnError) {
  test::FakeArm arm(7);
  arm.read_status = Status(StatusCode::kTimeout);
  ArmState state;
  state.stamp_ns = 42;
  EXPECT_EQ(arm.Read(state).code(), StatusCode::kTimeout);
  EXPECT_EQ(state.stamp_ns, 42);
  arm.read_status = Status::Ok();
  arm.state.num_joints = 5;  // differs from the driver's own number of joints
  EXPECT_EQ(arm.Read(state).code(), StatusCode::kDeviceFault);
  EXPECT_EQ(state.stamp_ns, 42);
}

class CameraTest : public testing::Test {
 protected:
  Frame Good() {
    Frame frame;
    frame.width_px = 4;
    frame.height_px = 3;
    frame.stride_bytes = 12;
    frame.pixels = pixels_;
    return frame;
  }
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(36);
  test::FakeCamera camera_;
};

TEST_F(CameraTest, HandsOutAGoodFrame) {
  camera_.frames.push_back(Good());
  Frame frame;
  EXPECT_TRUE(camera_.Acquire(frame, 0).ok());
  EXPECT_EQ(frame.pixels.size(), 36U);
  EXPECT_EQ(camera_.Acquire(frame, 0).code(), StatusCode::kClosed);
}

TEST_F(CameraTest, RefusesImpossibleGeometry) {
  std::vector<Frame> bad(5, Good());
  bad[0].width_px = 0;
  bad[1].height_px = -1;
  bad[2].stride_bytes = 11;
  bad[3].pixels = bad[3].pixels.first(35);
  bad[4].height_px = 1 << 30;
  for (const Frame& frame : bad) {
    camera_.frames.push_back(frame);
    Frame out;
    out.sequence = 99;
    EXPECT_EQ(camera_.Acquire(out, 0).code(), StatusCode::kDeviceFault);
    EXPECT_EQ(out.sequence, 99U);
  }
}

TEST_F(CameraTest, RefusesANegativeTimeout) {
  camera_.frames.push_back(Good());
  Frame frame;
  EXPECT_EQ(camera_.Acquire(frame, -1).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(camera_.frames.size(), 1U);
}

// No code deletes a driver through the seam.
static_assert(!std::is_destructible_v<Arm> && !std::is_destructible_v<Camera> &&
              !std::is_destructible_v<Clock> && !std::is_destructible_v<Recorder> &&
              !std::is_destructible_v<FeatureSink> && !std::is_destructible_v<TickProbe>);
static_assert(!std::is_copy_constructible_v<test::FakeArm>);

TEST(EventsTest, NamesAreUniqueAndEveryCauseHasAKey) {
  std::set<std::string> names;
  for (int i = 0; i < kNumFaults; ++i) {
    const auto fault = static_cast<Fault>(i);
    EXPECT_TRUE(names.insert(Name(fault)).second) << Name(fault);
    // A non-finite value is an immediate fault: no key can soften it.
    const bool has_no_key =
        fault == Fault::kNone || fault == Fault::kNonFiniteFeature || fault == Fault::kNonFiniteControl;
    EXPECT_EQ(std::string(Key(fault)).empty(), has_no_key) << Name(fault);
  }
  names.clear();
  for (int i = 0; i < kNumLimits; ++i) {
    const auto limit = static_cast<Limit>(i);
    EXPECT_TRUE(names.insert(Name(limit)).second) << Name(limit);
    EXPECT_FALSE(std::string(Key(limit)).empty());
    EXPECT_EQ(Bit(limit), 1U << i);
  }
  names.clear();
  for (int i = 0; i < kNumModes; ++i) {
    const auto mode = static_cast<Mode>(i);
    EXPECT_TRUE(names.insert(Name(mode)).second) << Name(mode);
  }
  EXPECT_EQ(names.count("unknown"), 0U);
  EXPECT_STREQ(Name(static_cast<Mode>(kNumModes)), "unknown") << "a mode out of range";
}

TEST(EventsTest, EveryHoldReasonHasAUniqueName) {
  std::set<std::string> names;
  for (int i = 0; i < kNumHoldReasons; ++i) {
    EXPECT_TRUE(names.insert(Name(static_cast<HoldReason>(i))).second);
  }
  EXPECT_EQ(names.count("unknown"), 0U);
}

// A value decoded from a line or a file may be out of the enumeration's range.
TEST(EventsTest, ValueOutOfRangeIsNamedUnknown) {
  EXPECT_STREQ(Name(static_cast<HoldReason>(200)), "unknown");
  EXPECT_STREQ(Name(static_cast<Fault>(200)), "unknown");
  EXPECT_STREQ(Name(static_cast<Limit>(200)), "unknown");
  EXPECT_STREQ(Key(static_cast<Fault>(200)), "");
  EXPECT_STREQ(Key(static_cast<Limit>(200)), "");
  EXPECT_STREQ(ToString(static_cast<StatusCode>(200)), "unknown status");
}

TEST(StatusTest, EveryCodeHasUniqueWords) {
  std::set<std::string> words;
  for (int i = 0; i <= static_cast<int>(StatusCode::kOutOfRange); ++i) {
    EXPECT_TRUE(words.insert(ToString(static_cast<StatusCode>(i))).second);
  }
  EXPECT_EQ(words.count("unknown status"), 0U);
}

}  // namespace
}  // namespace fovea::hal
