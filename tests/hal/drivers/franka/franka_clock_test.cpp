// SPDX-License-Identifier: Apache-2.0
// The robot's time as a hal::Clock, tested against the contract.
#include "fovea/franka/robot_clock.hpp"
#include "tests/contract/clock_contract.hpp"

namespace fovea::test {
namespace {

struct RobotClockFixture {
  franka::RobotClock driver;
  hal::Clock& clock() { return driver; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(RobotClock, ClockContract, RobotClockFixture);

TEST(RobotClockTest, OlderStateDoesNotTurnItBack) {
  franka::RobotClock clock;
  clock.Advance(7);
  clock.Advance(3);
  EXPECT_EQ(clock.NowNs(), 7);
}

}  // namespace
}  // namespace fovea::test
