// SPDX-License-Identifier: Apache-2.0
// The robot behind its interface, without a network, for tests that step it by 1 ms.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/sim/panda/wire_panda.hpp"

namespace fovea::test {

// The largest difference of an entry.
inline double Off(const franka::Vector7& a, const franka::Vector7& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, std::fabs(a[i] - b[i]));
  }
  return most;
}

class FciRobotTest : public testing::Test {
 protected:
  explicit FciRobotTest(std::vector<sim::CartesianWall> walls = {},
                        const sim::WorldConfig& world = WirePandaWorld())
      : panda_(world, std::move(walls)) {}

  sim::FciRobot& robot() { return panda_.robot; }
  const franka::RobotState& state() { return panda_.robot.state(); }

  void Move(franka::MoveController controller, franka::MoveGenerator generator) {
    franka::MoveRequest request;
    request.controller = controller;
    request.generator = generator;
    ASSERT_EQ(robot().Move(request), franka::MoveStatus::kMotionStarted);
    ASSERT_EQ(state().robot_mode, franka::RobotMode::kMove);
    begin_ = state();
  }
  // The command that stays where the motion began.
  franka::RobotCommand Still() {
    franka::RobotCommand c;
    c.message_id = state().message_id;
    c.q_c = begin_.q_d;
    c.O_T_EE_c = begin_.O_T_EE_d;
    c.elbow_c = begin_.elbow_d;  // used only with valid_elbow
    c.tau_J_d = state().tau_J_d;
    return c;
  }

 public:
  // A fade from 0 to 1 within `steps`, at rest at both ends: x^4 (35 - 84 x + 70 x^2 - 20 x^3).
  static double Fade(int k, int steps) {
    const double x = std::min(1.0, static_cast<double>(k) / steps);
    return x * x * x * x * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * x * x * x);
  }

 protected:
  void Finish() {
    franka::RobotCommand c = Still();
    c.motion_generation_finished = 1;
    robot().Step(c);
    EXPECT_EQ(robot().TakeMoveEnd(), franka::MoveStatus::kSuccess);
    EXPECT_EQ(state().robot_mode, franka::RobotMode::kIdle);
  }
  std::string Reason() { return franka::FirstError(state().reflex_reason); }
  // Runs a motion of `steps` by `command`, then holds its end for 300 ms.
  void Run(int steps, const std::function<void(int, franka::RobotCommand&)>& command) {
    for (int k = 1; k <= steps + 300; ++k) {
      franka::RobotCommand c = Still();
      command(k, c);
      robot().Step(c);
      ASSERT_EQ(state().robot_mode, franka::RobotMode::kMove) << "at step " << k << ": " << Reason();
    }
  }

  // Torques that pull the joints to `q_goal`, as an external controller may command them.
  franka::RobotCommand Towards(const franka::Vector7& q_goal) {
    constexpr franka::Vector7 kStiffness{400, 400, 300, 300, 100, 60, 30};
    constexpr franka::Vector7 kDamping{40, 40, 30, 30, 8, 4, 2};
    franka::RobotCommand c = Still();
    for (std::size_t i = 0; i < q_goal.size(); ++i) {
      const double wish = kStiffness[i] * (q_goal[i] - state().q[i]) - kDamping[i] * state().dq[i];
      c.tau_J_d[i] += std::clamp(wish - c.tau_J_d[i], -1.0, 1.0);
    }
    return c;
  }
  // Steps with `command` until the motion ends, at most `steps` times.
  void RunUntilItStops(int steps, const std::function<franka::RobotCommand(int)>& command) {
    for (int k = 1; k <= steps && robot().moving(); ++k) {
      robot().Step(command(k));
    }
  }
  void Wait(int steps) {
    for (int k = 0; k < steps; ++k) {
      robot().Step(std::nullopt);
    }
  }
  // Sets the torque and force above which collisions are detected; contacts keep the default thresholds.
  void SetCollisionsFrom(double torque, double force) {
    franka::CollisionBehavior behavior;
    for (franka::Vector7* most : {&behavior.upper_torque_acceleration, &behavior.upper_torque_nominal}) {
      most->fill(torque);
    }
    for (franka::Vector6* most : {&behavior.upper_force_acceleration, &behavior.upper_force_nominal}) {
      most->fill(force);
    }
    ASSERT_EQ(robot().Set(franka::Command::kSetCollisionBehavior, franka::Bytes(behavior)),
              franka::SetterStatus::kSuccess);
  }
  // Checks for a reflex with this error only, after which the arm comes to rest.
  void ExpectReflex(franka::Error error) {
    EXPECT_EQ(state().robot_mode, franka::RobotMode::kReflex);
    EXPECT_EQ(Reason(), franka::Name(error));
    EXPECT_EQ(state().errors, OnlyFlag(error));
    EXPECT_EQ(robot().TakeMoveEnd(), franka::MoveStatus::kReflexAborted);
    Wait(500);
    EXPECT_LT(Off(state().dq, {}), 1e-2) << "the arm is at rest";
  }
  static franka::ErrorFlags OnlyFlag(franka::Error error) {
    franka::ErrorFlags flags{};
    flags[static_cast<std::size_t>(error)] = 1;
    return flags;
  }
  // The displacement of the end effector since the start of the motion [m].
  franka::Vector3 Way() {
    return {state().O_T_EE[12] - begin_.O_T_EE[12], state().O_T_EE[13] - begin_.O_T_EE[13],
            state().O_T_EE[14] - begin_.O_T_EE[14]};
  }

  PandaAlone panda_;
  franka::RobotState begin_;
};

}  // namespace fovea::test
