// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/arm_spring.hpp"

#include <gtest/gtest.h>

#include <random>

#include "sim/robot/chain.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

class ArmSpringTest : public testing::Test {
 protected:
  SimRobot robot_ = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  Chain chain_{robot_};
};

// The torques are the gradient of the spring's energy: compares with finite differences at random postures,
// links and points.
TEST_F(ArmSpringTest, TorquesFollowFromTheSpringsEnergy) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> even(-1.0, 1.0);
  const auto point = [&](double size) {
    return Eigen::Vector3d(size * Eigen::Vector3d(even(random), even(random), even(random)));
  };
  double worst = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(7, [&] { return 1.5 * even(random); });
    ArmSpring spring;
    spring.link = static_cast<int>(random() % robot_.links.size());
    spring.p_LP = point(0.1);
    const auto place = [&](const Eigen::VectorXd& at) {
      return Eigen::Vector3d(chain_.LinkPoses(at)[static_cast<std::size_t>(spring.link)] * spring.p_LP);
    };
    spring.p_BT = place(q) + point(0.1);  // at most 35 N
    const auto energy = [&](const Eigen::VectorXd& at) {
      return 0.5 * ArmSpring::kStiffness * (spring.p_BT - place(at)).squaredNorm();
    };
    const Eigen::VectorXd tau = SpringTorque(spring, robot_, chain_.LinkPoses(q), Eigen::VectorXd::Zero(7));
    for (int i = 0; i < 7; ++i) {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(7);
      step[i] = 1e-6;
      worst = std::max(worst, std::fabs(tau[i] + (energy(q + step) - energy(q - step)) / 2e-6));
    }
  }
  RecordProperty("worst_difference_Nm", std::to_string(worst));
  EXPECT_LT(worst, 1e-5);
}

TEST_F(ArmSpringTest, ForceIsBoundedAndDamped) {
  ArmSpring spring;
  spring.p_BT = {10.0, 0.0, 0.0};
  EXPECT_NEAR(SpringForce(spring, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()).norm(),
              ArmSpring::kMostForce, 1e-12);
  spring.p_BT.setZero();
  const Eigen::Vector3d braking = SpringForce(spring, Eigen::Vector3d::Zero(), {0.1, 0.0, 0.0});
  EXPECT_NEAR(braking.x(), -ArmSpring::kDamping * 0.1, 1e-12);
}

}  // namespace
}  // namespace fovea::sim
