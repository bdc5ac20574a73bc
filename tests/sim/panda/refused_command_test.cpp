// SPDX-License-Identifier: Apache-2.0
// Every error caused by a command, at the robot's interface without a network.
#include "tests/sim/panda/robot_fixture.hpp"

namespace fovea::test {
namespace {

using franka::Error;
using franka::MoveController;
using franka::MoveGenerator;
using franka::MoveStatus;
using franka::RobotCommand;
using franka::RobotMode;

// A class of bad commands and its error.
struct Refused {
  const char* what;
  MoveController controller;
  MoveGenerator generator;
  std::function<void(int k, RobotCommand&)> command;
  Error error;
};
class RefusedCommand : public FciRobotTest, public testing::WithParamInterface<Refused> {};

TEST_P(RefusedCommand, RaisesTheReflexOfItsKind) {
  Move(GetParam().controller, GetParam().generator);
  for (int k = 1; k <= 4000 && robot().moving(); ++k) {
    RobotCommand c = Still();
    GetParam().command(k, c);
    robot().Step(c);
  }
  EXPECT_EQ(state().robot_mode, RobotMode::kReflex);
  EXPECT_EQ(Reason(), franka::Name(GetParam().error));
  EXPECT_EQ(state().errors[static_cast<std::size_t>(GetParam().error)], 1);
  EXPECT_EQ(robot().TakeMoveEnd(), MoveStatus::kReflexAborted);
  EXPECT_EQ(robot().Move({}), MoveStatus::kNotPossible) << "before recovery";
  for (int k = 0; k < 300; ++k) {
    robot().Step(std::nullopt);
  }
  EXPECT_LT(Off(state().dq, {}), 1e-2) << "the arm is at rest";
  EXPECT_EQ(robot().Recover(), franka::RecoveryStatus::kSuccess);
  EXPECT_EQ(state().robot_mode, RobotMode::kIdle);
  EXPECT_EQ(state().errors, franka::ErrorFlags{});
  EXPECT_EQ(Reason(), franka::Name(GetParam().error)) << "the reason stays until the next motion";
  franka::MoveRequest again;
  again.generator = MoveGenerator::kJointPosition;
  EXPECT_EQ(robot().Move(again), MoveStatus::kMotionStarted);
  EXPECT_EQ(Reason(), "none");
}

constexpr auto kJoint = MoveController::kJointImpedance;
INSTANTIATE_TEST_SUITE_P(
    Kinds, RefusedCommand,
    testing::Values(
        Refused{"start", kJoint, MoveGenerator::kJointPosition,
                [](int, RobotCommand& c) { c.q_c[3] += 0.05; }, Error::kJointPositionStartPoseInvalid},
        Refused{"joint_limit", kJoint, MoveGenerator::kJointPosition,
                [](int k, RobotCommand& c) { c.q_c[5] -= 2.0 * (1.0 - std::cos(k * 5e-4)); },
                Error::kJointPositionLimitsOfMotion},
        Refused{"joint_speed", kJoint, MoveGenerator::kJointVelocity,
                [](int k, RobotCommand& c) { c.dq_c[0] = 5e-3 * k; }, Error::kJointVelocityLimitsOfMotion},
        Refused{"joint_step", kJoint, MoveGenerator::kJointVelocity,
                [](int k, RobotCommand& c) { c.dq_c[0] = k > 5 ? 0.1 : 0.0; },
                Error::kJointVelocityDiscontinuity},
        Refused{"joint_jerk", kJoint, MoveGenerator::kJointVelocity,
                [](int k, RobotCommand& c) { c.dq_c[0] = k % 2 == 0 ? 5e-3 : 0.0; },
                Error::kJointAccelerationDiscontinuity},
        Refused{"frame", kJoint, MoveGenerator::kCartesianPosition,
                [](int, RobotCommand& c) { c.O_T_EE_c[0] = 2.0; }, Error::kCartesianPositionInvalidFrame},
        Refused{"pose_start", kJoint, MoveGenerator::kCartesianPosition,
                [](int, RobotCommand& c) { c.O_T_EE_c[12] += 0.05; },
                Error::kCartesianPositionStartPoseInvalid},
        Refused{"elbow_start", kJoint, MoveGenerator::kCartesianPosition,
                [](int, RobotCommand& c) {
                  c.valid_elbow = 1;
                  c.elbow_c = {0.5, -1.0};
                },
                Error::kCartesianStartElbowInvalid},
        Refused{"elbow_sign", kJoint, MoveGenerator::kCartesianPosition,
                [](int, RobotCommand& c) {
                  c.valid_elbow = 1;
                  c.elbow_c = {0.0, 1.0};
                },
                Error::kStartElbowSignInconsistent},
        Refused{"elbow_speed", kJoint, MoveGenerator::kCartesianPosition,
                [](int k, RobotCommand& c) {
                  c.valid_elbow = 1;
                  c.elbow_c = {k > 1 ? 0.005 : 0.0, -1.0};
                },
                Error::kCartesianElbowLimit},
        Refused{"elbow_sign_on_the_way", kJoint, MoveGenerator::kCartesianPosition,
                [](int k, RobotCommand& c) {
                  c.valid_elbow = 1;
                  c.elbow_c[1] = k > 1 ? 1.0 : -1.0;
                },
                Error::kCartesianElbowSignInconsistent},
        Refused{"twist_to_a_joint_limit", kJoint, MoveGenerator::kCartesianVelocity,
                [](int k, RobotCommand& c) { c.O_dP_EE_c[5] = -1.0 * FciRobotTest::Fade(k, 400); },
                Error::kCartesianJointPositionLimits},
        Refused{"twist_too_fast_for_a_joint", kJoint, MoveGenerator::kCartesianVelocity,
                [turned = 0.0](int k, RobotCommand& c) mutable {
                  c.valid_elbow = 1;
                  const double w = 2.3 * FciRobotTest::Fade(k, 800);  // about the base's z axis
                  turned += 1e-3 * w;
                  const double radius = std::hypot(c.O_T_EE_c[12], c.O_T_EE_c[13]);
                  c.O_dP_EE_c = {-w * radius * std::sin(turned), w * radius * std::cos(turned), 0, 0, 0, w};
                },
                Error::kCartesianJointVelocityLimits},
        Refused{"twist_too_sudden_for_a_joint", kJoint, MoveGenerator::kCartesianVelocity,
                [](int k, RobotCommand& c) {
                  c.valid_elbow = 1;
                  const double after_s = 1e-3 * k;  // 12 m/s^2 within 10 ms
                  c.O_dP_EE_c[1] = k <= 10 ? 600.0 * after_s * after_s : 0.06 + 12.0 * (after_s - 0.01);
                },
                Error::kCartesianJointVelocityDiscontinuity},
        Refused{"twist_too_jerky_for_a_joint", kJoint, MoveGenerator::kCartesianVelocity,
                [](int k, RobotCommand& c) {
                  c.valid_elbow = 1;
                  c.O_dP_EE_c[1] = k > 5 ? 3e-3 : 0.0;
                },
                Error::kCartesianJointAccelerationDiscontinuity},
        Refused{"twist_speed", kJoint, MoveGenerator::kCartesianVelocity,
                [](int k, RobotCommand& c) { c.O_dP_EE_c[5] = 2.7 * FciRobotTest::Fade(k, 600); },
                Error::kCartesianVelocityLimits},
        Refused{"twist_step", kJoint, MoveGenerator::kCartesianVelocity,
                [](int k, RobotCommand& c) { c.O_dP_EE_c[0] = k > 5 ? 0.05 : 0.0; },
                Error::kCartesianVelocityDiscontinuity},
        Refused{"twist_jerk", kJoint, MoveGenerator::kCartesianVelocity,
                [](int k, RobotCommand& c) { c.O_dP_EE_c[0] = k % 2 == 0 ? 8e-3 : 0.0; },
                Error::kCartesianAccelerationDiscontinuity},
        Refused{"torque_step", MoveController::kExternal, MoveGenerator::kJointVelocity,
                [](int k, RobotCommand& c) { c.tau_J_d[0] = k > 5 ? 3.0 : 0.0; },
                Error::kControllerTorqueDiscontinuity},
        Refused{"not_a_number", MoveController::kExternal, MoveGenerator::kJointVelocity,
                [](int, RobotCommand& c) { c.tau_J_d[3] = std::nan(""); },
                Error::kControllerTorqueDiscontinuity},
        Refused{"too_fast", MoveController::kExternal, MoveGenerator::kJointVelocity,
                [](int k, RobotCommand& c) { c.tau_J_d[0] = std::min(0.9 * k, 60.0); },
                Error::kJointVelocity}),
    [](const auto& test) { return test.param.what; });

}  // namespace
}  // namespace fovea::test
