// SPDX-License-Identifier: Apache-2.0
// The Panda's driver as the program uses it, with a robot on the network that the test controls.
#include "firmware/targets/linux/robots/fci/fci_driver.hpp"

#include <gtest/gtest.h>

#include <string>
#include <thread>

#include "firmware/targets/linux/hw_config.hpp"
#include "tests/hal/drivers/franka/fake_robot.hpp"

namespace fovea::hw {
namespace {

// While a motion ends, the robot's success rate also counts states that need no command any more.
TEST(FciDriverTest, SuccessRateIsThatBeforeStop) {
  test::FakeRobot robot;
  const HwConfig config =
      LoadHwConfig("loopback", {"robot.port=" + std::to_string(robot.port()), "robot.state_timeout_ms=50"});
  FciDriver driver(config);
  std::thread set_up([&robot] { EXPECT_TRUE(robot.ServeSetUp()); });
  hal::Arm& arm = driver.Connect(/*allow_motion=*/true);
  set_up.join();
  hal::ArmState state;
  robot.SendState();
  ASSERT_TRUE(arm.Read(state).ok());
  hal::ArmCommand command;
  command.num_joints = 7;
  ASSERT_TRUE(arm.Write(command).ok());
  const auto move = robot.Take();
  ASSERT_TRUE(move.has_value());
  robot.AnswerStatus(*move, 1);
  robot.ShowMove();
  robot.state.control_command_success_rate = 0.75;
  robot.SendState();
  ASSERT_TRUE(arm.Read(state).ok());
  EXPECT_EQ(driver.figures().command_success_rate, 0.75);
  const std::uint64_t states = driver.figures().states;

  robot.ShowIdle();
  robot.state.control_command_success_rate = 0.25;
  robot.SendState();
  driver.Stop();
  EXPECT_EQ(driver.figures().states, states + 1) << "Stop has read the state";
  EXPECT_EQ(driver.figures().command_success_rate, 0.75);
}

}  // namespace
}  // namespace fovea::hw
