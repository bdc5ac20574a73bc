// SPDX-License-Identifier: Apache-2.0
// Keeps the target in the picture: the rows against finite differences, and a target that moves out.
#include "firmware/core/barriers/field_of_view_barrier.hpp"

#include <gtest/gtest.h>

#include <iostream>

#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/features/square.hpp"
#include "tests/core/features/camera_steps.hpp"
#include "tests/support/panda.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

const config::ViewConfig kView{true, -0.55, 0.55, -0.42, 0.42};

struct Scene {
  features::TargetOutline outline;
  features::TargetInCamera seen;
  model::Mat6N J_C;
};

Scene RandomScene(test::RandomStates& random, const config::ServoConfig& config) {
  Scene scene;
  model::ArmPoses poses;
  model::ComputePoses(config.arm, test::Ready() + random.Joints(config.arm, 0.5), poses);
  model::ComputeJacobian(config.arm, poses, config.X_EC, scene.J_C);
  scene.seen = test::RandomView(random, 0.4);
  scene.outline.num_points = 4;
  scene.outline.p_OP = features::MakeSquare(0.08).corners;
  return scene;
}

MotionLimits Limits(const config::ViewConfig& view, const Scene& scene) {
  MotionLimits limits;
  config::GuardConfig guard;
  guard.view = view;
  for (const Barrier& side : FieldOfViewBarriers(guard, {scene.outline, scene.seen, scene.J_C})) {
    limits.Add(side);
  }
  return limits;
}

// The largest -x, x, -y and y of all corners.
std::array<double, 4> Extent(const Scene& scene, const features::TargetInCamera& seen) {
  std::array<double, 4> most;
  most.fill(-1e9);
  for (const Vec3& p_OP : scene.outline.p_OP) {
    const Vec3 p = seen.X_CO * p_OP;
    const double x = p.x() / p.z();
    const double y = p.y() / p.z();
    most = {std::max(most[0], -x), std::max(most[1], x), std::max(most[2], -y), std::max(most[3], y)};
  }
  return most;
}

// a^T dq must be the image velocity of the outermost corner caused by the camera's motion.
TEST(FieldOfViewBarrierTest, RowsMatchFiniteDifferencesOfTheOutermostCorner) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(61);
  double worst = 0.0;
  for (int k = 0; k < 300; ++k) {
    const Scene scene = RandomScene(random, config);
    const MotionLimits limits = Limits(kView, scene);
    ASSERT_EQ(limits.num_rows, 4);
    const model::VecN dq = random.Joints(config.arm, 0.5);
    const model::Vec6 V = scene.J_C * dq;
    features::TargetInCamera still = scene.seen;
    still.v_BO_C.setZero();
    still.w_BO_C.setZero();
    constexpr double kDt = 1e-6;
    const auto plus = Extent(scene, test::AfterSteps(still, V, kDt));
    const auto minus = Extent(scene, test::AfterSteps(still, V, -kDt));
    for (std::size_t i = 0; i < 4; ++i) {
      const double rate = (plus[i] - minus[i]) / (2.0 * kDt);
      worst = std::max(worst, std::abs(limits.rows[i].a.dot(dq) - rate) / std::max(1.0, std::abs(rate)));
    }
  }
  std::cout << "worst relative difference: " << worst << "\n";
  EXPECT_LT(worst, 1e-6);
}

TEST(FieldOfViewBarrierTest, StandstillIsAllowedAndOutsideNoMotionGoesFurtherOut) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(62);
  for (int k = 0; k < 300; ++k) {
    const Scene scene = RandomScene(random, config);
    const MotionLimits limits = Limits(kView, scene);
    const auto extent = Extent(scene, scene.seen);
    const double bounds[] = {-kView.x_min, kView.x_max, -kView.y_min, kView.y_max};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_GE(limits.rows[i].b, 0.0);
      if (extent[i] > bounds[i] && scene.seen.v_BO_C.isZero()) {
        EXPECT_EQ(limits.rows[i].b, 0.0);
      }
    }
  }
}

TEST(FieldOfViewBarrierTest, RowsUseTheSphereOutlineAndNeedATargetInView) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(63);
  Scene scene = RandomScene(random, config);
  scene.outline.num_points = 1;
  scene.outline.p_OP[0].setZero();
  scene.outline.radius = 0.04;
  scene.seen = {{model::Mat3::Identity(), {0.1, 0.0, 0.4}}, Vec3::Zero(), Vec3::Zero()};
  EXPECT_NEAR(Limits(kView, scene).rows[1].b, 1.5 * (0.55 - 0.25 - 0.1), 1e-12);
  scene.seen.v_BO_C = {0.04, 0.0, 0.0};  // the target itself moves out: dx/dt = 0.1
  EXPECT_NEAR(Limits(kView, scene).rows[1].b, 1.5 * (0.55 - 0.25 - 0.1) - 0.1, 1e-12);
  scene.seen.X_CO.p.z() = -0.4;
  EXPECT_EQ(Limits(kView, scene).num_rows, 0);
  EXPECT_EQ(Limits(config::ViewConfig{}, scene).num_rows, 0);
}

}  // namespace
}  // namespace fovea::barriers
