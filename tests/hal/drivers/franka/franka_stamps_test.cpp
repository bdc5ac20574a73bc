// SPDX-License-Identifier: Apache-2.0
// Maps the robot's time to the computer's clock from the arrivals of its states.
#include <gtest/gtest.h>

#include <chrono>
#include <iostream>
#include <thread>

#include "fovea/linux_rt/monotonic_clock.hpp"
#include "tests/hal/drivers/franka/fake_robot.hpp"

namespace fovea::test {
namespace {

// The arm without a RobotClock: its stamps are in the computer's time.
struct Connected {
  Connected() {
    std::jthread other([this] { EXPECT_TRUE(robot.ServeSetUp()); });
    arm.emplace(ConfigFor(robot));
  }
  // The stamp of the robot's next state, sent now [ns].
  std::int64_t Next() {
    robot.SendState();
    hal::ArmState state;
    EXPECT_TRUE(arm->Read(state).ok());
    return state.stamp_ns;
  }
  FakeRobot robot;
  std::optional<franka::FrankaArm> arm;
};

TEST(FrankaArm, StampsFollowTheEarliestArrivals) {
  Connected connected;
  const std::int64_t first_ns = connected.Next();
  connected.Next();
  connected.Next();
  std::this_thread::sleep_for(20ms);
  // A state that arrives 20 ms late is stamped as if it were on time.
  const double span_ms = static_cast<double>(connected.Next() - first_ns) * 1e-6;
  std::cout << "four states in " << span_ms << " ms of stamps\n";
  EXPECT_LT(span_ms, 3.01);
}

// The robot's time stops for 80 ms. The mapping must recover within a second, not by 0.2 ms per second.
TEST(FrankaArm, StalledRobotClockIsLearnedAgain) {
  Connected connected;
  connected.Next();
  std::this_thread::sleep_for(80ms);
  const std::int64_t begin_ns = linux_rt::MonotonicNs();
  constexpr int kStates = 1010;
  double off_ms = 0.0;
  for (int k = 0; k < kStates; ++k) {
    const std::int64_t due_ns = begin_ns + k * hal::kNsPerMs;
    linux_rt::SleepUntilNs(due_ns);
    off_ms = static_cast<double>(connected.Next() - due_ns) * 1e-6;
    if (k == 500) {
      std::cout << "half a second later: off by " << off_ms << " ms\n";
      EXPECT_LT(off_ms, -60.0) << "after half a second it may still be a network delay";
    }
  }
  std::cout << "a second later: off by " << off_ms << " ms\n";
  EXPECT_GE(off_ms, 0.0);
  EXPECT_LT(off_ms, 10.0);
}

}  // namespace
}  // namespace fovea::test
