// SPDX-License-Identifier: Apache-2.0
// The robot's own controllers yield according to the set stiffness: displacement of the hand under a pull.
#include <iostream>
#include <numbers>

#include "tests/sim/panda/robot_fixture.hpp"

namespace fovea::test {
namespace {

using franka::Command;
using franka::MoveController;
using franka::MoveGenerator;
using franka::SetterStatus;

class ImpedanceTest : public FciRobotTest {
 protected:
  // The displacement of the hand under 10 N along B's y, while it holds the start pose [m].
  double BentBy10N() {
    robot().PullHand({0.0, 10.0, 0.0});
    Run(1500, [](int, franka::RobotCommand&) {});
    robot().PullHand({0.0, 0.0, 0.0});
    const double bent = Way()[1];
    Run(1000, [](int, franka::RobotCommand&) {});
    Finish();
    return bent;
  }
  double BentWithJointStiffness(double share) {
    franka::JointImpedance stiffness;
    for (double& k : stiffness.K_theta) {
      k *= share;
    }
    EXPECT_EQ(robot().Set(Command::kSetJointImpedance, franka::Bytes(stiffness)), SetterStatus::kSuccess);
    Move(MoveController::kJointImpedance, MoveGenerator::kJointPosition);
    return BentBy10N();
  }
  double BentWithCartesianStiffness(double K) {
    franka::CartesianImpedance stiffness;
    stiffness.K_x = {K, K, K, 300, 300, 300};
    EXPECT_EQ(robot().Set(Command::kSetCartesianImpedance, franka::Bytes(stiffness)), SetterStatus::kSuccess);
    Move(MoveController::kCartesianImpedance, MoveGenerator::kJointPosition);
    return BentBy10N();
  }
};

TEST_F(ImpedanceTest, QuarterJointStiffnessBendsFourTimesAsFar) {
  SetCollisionsFrom(80.0, 80.0);
  const double stiff = BentWithJointStiffness(1.0);
  const double soft = BentWithJointStiffness(0.25);
  std::cout << "10 N bend it by " << 1e3 * stiff << " mm, with a quarter of the stiffness by " << 1e3 * soft
            << " mm\n";
  EXPECT_GT(stiff, 1e-4);
  EXPECT_NEAR(soft / stiff, 4.0, 0.4);
}

// The stiffness is along K's axes and equal in all directions. The hand's rotation adds to the displacement.
TEST_F(ImpedanceTest, HandYieldsByForceOverCartesianStiffness) {
  SetCollisionsFrom(80.0, 80.0);
  const double stiff = BentWithCartesianStiffness(2000.0);
  const double soft = BentWithCartesianStiffness(500.0);
  std::cout << "10 N bend 2000 N/m by " << 1e3 * stiff << " mm, 500 N/m by " << 1e3 * soft << " mm\n";
  EXPECT_NEAR(stiff, 10.0 / 2000.0, 1e-3);
  EXPECT_NEAR(soft, 10.0 / 500.0, 2e-3);
}

// A low-pass of cutoff f lags a steady motion by 1 / (2 pi f).
TEST_F(ImpedanceTest, FilterLagsTheReferenceByItsTimeConstant) {
  const auto lag = [&](double cutoff_hz) {
    franka::Filters filters;
    filters.joint_position = cutoff_hz;
    EXPECT_EQ(robot().Set(Command::kSetFilters, franka::Bytes(filters)), SetterStatus::kSuccess);
    Move(MoveController::kJointImpedance, MoveGenerator::kJointPosition);
    double most = 0.0;
    Run(600, [&](int k, franka::RobotCommand& c) {
      most = std::max(most, std::fabs(begin_.q_d[6] + 0.1 * Fade(k - 1, 600) - state().q_d[6]));
      c.q_c[6] += 0.1 * Fade(k, 600);
    });
    franka::RobotCommand end = Still();
    end.q_c[6] += 0.1;
    end.motion_generation_finished = 1;
    robot().Step(end);
    EXPECT_EQ(robot().TakeMoveEnd(), franka::MoveStatus::kSuccess);
    return most;
  };
  const double quick = lag(1000.0);
  const double slow = lag(10.0);
  constexpr double kFastest = 0.1 * 35.0 / 16.0 / 0.6;  // largest speed of the fade [rad/s]
  std::cout << "behind by " << quick << " rad at 1000 Hz, " << slow << " rad at 10 Hz\n";
  EXPECT_LT(quick, 1e-3);
  EXPECT_NEAR(slow, kFastest / (20.0 * std::numbers::pi), 1.5e-3);
}

}  // namespace
}  // namespace fovea::test
