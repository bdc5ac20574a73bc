// SPDX-License-Identifier: Apache-2.0
// Joint paths that keep the target in view: its place in the image against differences, and whole paths.
#include "firmware/core/control/way_in_view.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "firmware/core/features/triangle.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::control {
namespace {

using model::Pose;
using model::Vec3;
using model::VecN;

config::ServoConfig Config() {
  config::ServoConfig config = test::PandaConfig();
  config.feature.target = hal::FeatureKind::kTriangle;
  config.feature.form = features::FeatureForm::kPose;
  config.feature.corners = features::MakeTriangle(features::kDefaultTriangle);
  config.guard.view = {true, -0.55, 0.55, -0.42, 0.42};
  return config;
}

Pose CameraAt(const config::ServoConfig& config, const VecN& q) {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  return poses.X_BE * config.X_EC;
}

features::TargetInCamera SeenFrom(const config::ServoConfig& config, const VecN& q, const Pose& X_BO) {
  return {CameraAt(config, q).Inverse() * X_BO, Vec3::Zero(), Vec3::Zero()};
}

VecN WayFrom(const config::ServoConfig& config, const VecN& q, const VecN& to_goal, const Pose& X_BO) {
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  model::Mat6N J_C;
  model::ComputeJacobian(config.arm, poses, config.X_EC, J_C);
  return WayInView(to_goal, SeenFrom(config, q, X_BO), J_C, config.feature.p_CO_C_star);
}

// Along the path the image place x obeys dx/dt = -(x - x*) for any goal. The rest of the motion is unchanged.
TEST(WayInViewTest, TargetImageDecaysToItsGoalAndTheRestOfTheMotionStays) {
  const config::ServoConfig config = Config();
  test::RandomStates random(81);
  double worst = 0.0;
  double worst_rest = 0.0;
  for (int k = 0; k < 300; ++k) {
    const VecN q = test::Ready() + random.Joints(config.arm, 0.4);
    const Vec3 p_CO(random.Uniform(-0.2, 0.2), random.Uniform(-0.1, 0.1), 0.5);
    const Pose X_BO = CameraAt(config, q) * Pose{model::Mat3::Identity(), p_CO};
    const VecN to_goal = random.Joints(config.arm, 0.3);
    const VecN way = WayFrom(config, q, to_goal, X_BO);
    const auto place = [&](double dt) {
      const Vec3 p = SeenFrom(config, q + dt * way, X_BO).X_CO.p;
      return Eigen::Vector2d(p.x() / p.z(), p.y() / p.z());
    };
    constexpr double kDt = 1e-6;
    const Eigen::Vector2d rate = (place(kDt) - place(-kDt)) / (2.0 * kDt);
    worst = std::max(worst, (rate + place(0.0)).norm());
    // The correction lies in the span of the two image rows: a second one changes nothing.
    worst_rest = std::max(worst_rest, (WayFrom(config, q, way, X_BO) - way).norm());
  }
  std::cout << "off by " << worst << " 1/s; a second correction changes it by " << worst_rest << " rad\n";
  EXPECT_LT(worst, 1e-5);
  EXPECT_LT(worst_rest, 1e-5);
}

TEST(WayInViewTest, TargetBehindTheCameraLeavesThePathUnchanged) {
  const config::ServoConfig config = Config();
  const Pose X_BO = CameraAt(config, test::Ready()) * Pose{model::Mat3::Identity(), {0.0, 0.0, -0.4}};
  const VecN to_goal = test::Ready();
  EXPECT_EQ((WayFrom(config, test::Ready(), to_goal, X_BO) - to_goal).norm(), 0.0);
}

WayTrial Try(const config::ServoConfig& config, const Pose& X_BO, const VecN& q, const VecN& q_goal) {
  WayTrial way;
  way.q = q;
  int steps = 0;
  while (steps < 1000 && StepOnWay(config, X_BO, q_goal, way)) {
    ++steps;
  }
  EXPECT_LT(steps, 100);
  return way;
}

// The last joint turns by 2 rad: the target stays in the middle, and the path is about 2 rad long.
TEST(WayInViewTest, ClearPathIsFollowedToItsEnd) {
  const config::ServoConfig config = Config();
  VecN q_goal = test::Ready();
  q_goal[6] -= 2.0;
  const Pose X_BO = CameraAt(config, q_goal) * Pose{config.feature.R_CO_star, config.feature.p_CO_C_star};
  const WayTrial way = Try(config, X_BO, test::Ready(), q_goal);
  EXPECT_FALSE(way.barred);
  EXPECT_NEAR(way.length, 2.0, 0.3);
  EXPECT_LT((way.q - q_goal).lpNorm<Eigen::Infinity>(), 0.16);
}

TEST(WayInViewTest, PathBelowAPlaneBehindTheArmOrOutOfViewIsBlocked) {
  config::ServoConfig config = Config();
  VecN q_goal = test::Ready();
  q_goal[0] += 0.5;
  const Pose X_BO = CameraAt(config, q_goal) * Pose{config.feature.R_CO_star, config.feature.p_CO_C_star};
  EXPECT_FALSE(Try(config, X_BO, test::Ready(), q_goal).barred);

  config::ServoConfig below = config;
  below.guard.obstacles.num_planes = 1;
  below.guard.obstacles.planes[0] = {{0.0, 0.0, 1.0}, CameraAt(config, q_goal).p.z() + 0.2};
  EXPECT_TRUE(Try(below, X_BO, test::Ready(), q_goal).barred);

  config::ServoConfig hidden = config;
  hidden.guard.sight_clearance = 10.0;  // so large a clearance hides every target
  EXPECT_TRUE(Try(hidden, X_BO, test::Ready(), q_goal).barred);

  config::ServoConfig narrow = config;
  narrow.guard.view = {true, 0.4, 0.5, 0.3, 0.4};
  EXPECT_TRUE(Try(narrow, X_BO, test::Ready(), q_goal).barred);
}

}  // namespace
}  // namespace fovea::control
