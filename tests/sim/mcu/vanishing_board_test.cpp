// SPDX-License-Identifier: Apache-2.0
// A board vanishes during a run: its emulator is killed.
#include <gtest/gtest.h>
#include <signal.h>

#include <iostream>
#include <string>

#include "sim/app/run.hpp"
#include "tests/sim/mcu/own_children.hpp"

namespace fovea::sim {
namespace {

TEST(VanishingBoard, ClosesTheBrakesAndIsReported) {
  const Scenario scenario =
      LoadScenario("ball", {"camera.enabled=false", "motion.kind=home", "run.duration_s=2"});
  RunOptions options;
  options.servo_image = FOVEA_MCU_IMAGE;
  options.report = false;
  options.show_progress = false;
  hal::TickRecord last;
  bool killed = false;
  options.observer.on_record = [&](const hal::TickRecord& record) {
    last = record;
    if (record.tick == 100 && !killed) {
      EXPECT_FALSE(record.command.engage_brakes);
      const std::vector<pid_t> children = test::OwnChildren();
      ASSERT_EQ(children.size(), 1U);
      kill(children.front(), SIGKILL);
      killed = true;
    }
  };
  try {
    RunScenario(scenario, options);
    FAIL() << "the run ended without an error";
  } catch (const std::runtime_error& error) {
    std::cout << error.what() << '\n';
    EXPECT_STREQ(error.what(), "the servo's board is gone; the arm's brakes were closed");
  }
  ASSERT_TRUE(killed);
  EXPECT_EQ(last.mode, hal::Mode::kFault);
  EXPECT_TRUE(last.command.engage_brakes);
  for (const double torque : last.command.tau_cmd) {
    EXPECT_EQ(torque, 0.0);
  }
  EXPECT_TRUE(test::OwnChildren().empty());  // no child process is left
}

}  // namespace
}  // namespace fovea::sim
