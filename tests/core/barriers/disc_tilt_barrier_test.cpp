// SPDX-License-Identifier: Apache-2.0
// The tilt of a disc's face to the line of sight: the row against differences, and when there is no row.
#include "firmware/core/barriers/disc_tilt_barrier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;
using model::VecN;

constexpr double kCosineMin = 0.5;

config::GuardConfig With(double cosine_min) {
  config::GuardConfig guard;
  guard.view.disc_cosine_min = cosine_min;
  return guard;
}

struct Camera {
  Camera(const config::ServoConfig& config, const VecN& q) {
    model::ArmPoses poses;
    model::ComputePoses(config.arm, q, poses);
    X_BC = poses.X_BE * config.X_EC;
    model::ComputeJacobian(config.arm, poses, config.X_EC, J_C);
  }

  [[nodiscard]] double Cosine(const Vec3& p_BO, const Vec3& normal_B) const {
    return normal_B.dot((p_BO - X_BC.p).normalized());
  }

  model::Pose X_BC;
  model::Mat6N J_C;
};

TEST(DiscTiltBarrierTest, RowMatchesFiniteDifferenceOfTheTilt) {
  const config::ServoConfig config = test::PandaConfig();
  test::RandomStates random(81);
  double worst = 0.0;
  int beyond = 0;
  for (int k = 0; k < 300; ++k) {
    const VecN q = test::Ready() + random.Joints(config.arm, 0.6);
    const Camera camera(config, q);
    const Vec3 p_C(random.Uniform(-0.2, 0.2), random.Uniform(-0.2, 0.2), random.Uniform(0.25, 0.9));
    const Vec3 turn(random.Uniform(-1.2, 1.2), random.Uniform(-1.2, 1.2), 0.0);
    const Vec3 normal_C = model::RotationOf(turn).col(2);
    MotionLimits limits;
    limits.Add(DiscTiltBarrier(With(kCosineMin), p_C, normal_C, camera.J_C));
    ASSERT_EQ(limits.num_rows, 1);
    const Vec3 p_BO = camera.X_BC * p_C;
    const Vec3 normal_B = camera.X_BC.R * normal_C;
    const double left = camera.Cosine(p_BO, normal_B) - kCosineMin;
    EXPECT_NEAR(limits.rows[0].b, 1.5 * std::max(left, 0.0), 1e-12);
    beyond += left < 0.0 ? 1 : 0;
    const VecN dq = random.Joints(config.arm, 0.5);
    constexpr double kDt = 1e-6;
    const double rate = (Camera(config, q + kDt * dq).Cosine(p_BO, normal_B) -
                         Camera(config, q - kDt * dq).Cosine(p_BO, normal_B)) /
                        (2.0 * kDt);
    worst = std::max(worst, std::abs(limits.rows[0].a.dot(dq) + rate));
  }
  std::cout << "off by at most " << worst << " 1/s; " << beyond << " of 300 beyond the tilt limit\n";
  EXPECT_LT(worst, 1e-7);
  EXPECT_GT(beyond, 20);
}

TEST(DiscTiltBarrierTest, NoRowWithoutATiltLimitOrAKnownDisc) {
  const config::ServoConfig config = test::PandaConfig();
  const Camera camera(config, test::Ready());
  MotionLimits limits;
  limits.Add(DiscTiltBarrier(With(0.0), {0.0, 0.0, 0.4}, Vec3::UnitZ(), camera.J_C));
  limits.Add(DiscTiltBarrier(With(kCosineMin), Vec3::Zero(), Vec3::UnitZ(), camera.J_C));
  limits.Add(DiscTiltBarrier(With(kCosineMin), {0.0, std::nan(""), 0.4}, Vec3::UnitZ(), camera.J_C));
  EXPECT_EQ(limits.num_rows, 0);
}

}  // namespace
}  // namespace fovea::barriers
