// SPDX-License-Identifier: Apache-2.0
// Finishing a motion: success at rest, a reflex at speed.
#include "fovea/franka/brake.hpp"
#include "tests/sim/panda/robot_fixture.hpp"

namespace fovea::test {
namespace {

using franka::Error;
using franka::MoveController;
using franka::MoveGenerator;
using franka::RobotCommand;

constexpr int kRise = 400;  // steps to full speed

// The path after k steps of a motion that rises smoothly to `speed` within kRise [rad or m].
double Gone(int k, double speed) {
  double way = 0.0;
  for (int j = 1; j <= k; ++j) {
    way += 1e-3 * speed * FciRobotTest::Fade(j, kRise);
  }
  return way;
}

class FinishTest : public FciRobotTest {
 protected:
  // Steps with `command` up to 100 steps at full speed, then finishes the motion.
  void FinishAtSpeed(const std::function<void(int, RobotCommand&)>& command) {
    RobotCommand c;
    for (int k = 1; k <= kRise + 100; ++k) {
      c = Still();
      command(k, c);
      robot().Step(c);
      ASSERT_TRUE(robot().moving()) << "at step " << k << ": " << Reason();
    }
    c.motion_generation_finished = 1;
    robot().Step(c);
  }
  // Accelerates joint 1 with torques up to `speed`.
  void PullUpTo(double speed) {
    Move(MoveController::kExternal, MoveGenerator::kJointVelocity);
    for (int k = 0; k < 3000 && state().dq[0] < speed; ++k) {
      RobotCommand c = Still();
      c.tau_J_d = {};
      c.tau_J_d[0] = std::min(8.0, state().tau_J_d[0] + 0.5);
      robot().Step(c);
      ASSERT_TRUE(robot().moving()) << Reason();
    }
    ASSERT_GE(state().dq[0], speed);
  }
};

TEST_F(FinishTest, FinishWithMovingJointsIsAReflex) {
  for (const double speed : {0.3, 0.5}) {
    for (const auto generator : {MoveGenerator::kJointPosition, MoveGenerator::kJointVelocity}) {
      Move(MoveController::kJointImpedance, generator);
      FinishAtSpeed([&](int k, RobotCommand& c) {
        c.q_c[5] -= Gone(k, speed);
        c.dq_c[5] = -speed * Fade(k, kRise);
      });
      std::cout << "finished at " << state().dq[5] << " rad/s: " << Reason() << '\n';
      ExpectReflex(Error::kJointVelocityDiscontinuity);
      ASSERT_EQ(robot().Recover(), franka::RecoveryStatus::kSuccess);
    }
  }
}

TEST_F(FinishTest, FinishWithAMovingHandIsAReflex) {
  for (const auto generator : {MoveGenerator::kCartesianPosition, MoveGenerator::kCartesianVelocity}) {
    Move(MoveController::kCartesianImpedance, generator);
    FinishAtSpeed([&](int k, RobotCommand& c) {
      c.O_T_EE_c[13] += Gone(k, 0.15);
      c.O_dP_EE_c[1] = 0.15 * Fade(k, kRise);
    });
    std::cout << "finished with a joint at " << Off(state().dq, {}) << " rad/s: " << Reason() << '\n';
    ExpectReflex(Error::kCartesianVelocityDiscontinuity);
    ASSERT_EQ(robot().Recover(), franka::RecoveryStatus::kSuccess);
  }
}

// The hand is at rest while the elbow swings.
TEST_F(FinishTest, FinishWithAMovingElbowIsAReflex) {
  Move(MoveController::kJointImpedance, MoveGenerator::kCartesianPosition);
  FinishAtSpeed([&](int k, RobotCommand& c) {
    c.valid_elbow = 1;
    c.elbow_c = franka::Vector2{begin_.elbow_d[0] + Gone(k, 0.3), begin_.elbow_d[1]};
  });
  ExpectReflex(Error::kCartesianJointVelocityDiscontinuity);
}

// A client with its own controller commands no speed, so the measured speed counts.
TEST_F(FinishTest, FinishOfATorqueMotionAtSpeedIsAReflex) {
  for (const double speed : {0.3, 0.5}) {
    PullUpTo(speed);
    RobotCommand c = Still();
    c.motion_generation_finished = 1;
    robot().Step(c);
    ExpectReflex(Error::kJointVelocityDiscontinuity);
    ASSERT_EQ(robot().Recover(), franka::RecoveryStatus::kSuccess);
  }
}

TEST_F(FinishTest, FinishOfATorqueMotionAtRestSucceeds) {
  PullUpTo(0.5);
  const franka::Vector7 q = state().q;
  for (int k = 0; k < 1000; ++k) {
    robot().Step(Towards(q));
  }
  EXPECT_LT(Off(state().dq, {}), 0.02);
  RobotCommand c = Still();
  c.motion_generation_finished = 1;
  robot().Step(c);
  EXPECT_EQ(robot().TakeMoveEnd(), franka::MoveStatus::kSuccess);
  EXPECT_EQ(state().robot_mode, franka::RobotMode::kIdle);
}

// As this project's driver ends a motion: damping first, then the finish.
TEST_F(FinishTest, FinishAfterTheDriverSlowedTheArmSucceeds) {
  PullUpTo(0.5);
  int states = 0;
  for (; franka::Moves(state().dq) && states < 500; ++states) {
    RobotCommand c = Still();
    const franka::Vector7 tau = franka::BrakingTorque(state().dq);
    for (std::size_t i = 0; i < tau.size(); ++i) {
      c.tau_J_d[i] += std::clamp(tau[i] - c.tau_J_d[i], -1.0, 1.0);
    }
    robot().Step(c);
    ASSERT_TRUE(robot().moving()) << Reason();
  }
  std::cout << "at rest after " << states << " ms\n";
  EXPECT_LT(states, 300);
  RobotCommand c = Still();
  c.motion_generation_finished = 1;
  robot().Step(c);
  EXPECT_EQ(robot().TakeMoveEnd(), franka::MoveStatus::kSuccess);
}

}  // namespace
}  // namespace fovea::test
