// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/resolve_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "firmware/core/barriers/disc_tilt_barrier.hpp"
#include "tests/support/panda.hpp"

namespace fovea::control {
namespace {

using model::VecN;

// An arm near a singular posture, with a task in joint space that leads further into it.
class ResolveMotionTest : public testing::Test {
 protected:
  ResolveMotionTest() : config_(test::PandaConfig()), q_(test::Ready()) {
    barriers::Singularity singularity;
    for (int step = 0; step < 1000; ++step) {
      model::ComputePoses(config_.arm, q_, poses_);
      model::ComputeJacobian(config_.arm, poses_, config_.X_EC, J_C_);
      barriers::ComputeSingularity(J_C_, barriers::SingularityConfig{}.length, singularity);
      sigma_ = singularity.sigma;
      if (sigma_ < 1.05 * config_.guard.singularity_min) {
        break;
      }
      q_ -= 0.01 * singularity.gradient.normalized();
      for (int i = 0; i < 7; ++i) {
        const model::Joint& joint = config_.arm.joints[static_cast<std::size_t>(i)];
        q_[i] = std::clamp(q_[i], joint.q_min + 0.1, joint.q_max - 0.1);
      }
    }
    model::ComputeLinearJacobian(config_.arm, poses_, poses_.X_BE.p, J_E_B_);
    reference_.q = q_;
    reference_.dq.setZero(7);
    reference_.ddq.setZero(7);
    task_.v = -0.5 * singularity.gradient.normalized();
    task_.J.setIdentity(7, 7);
    task_.dq_0.setZero(7);
    task_.weight.setOnes(7);
  }

  hal::LimitSet Resolve(bool by_joints) {
    MotionScene scene{reference_, poses_, J_E_B_, J_C_};
    scene.by_joints = by_joints;
    ResolveMotion(config_, task_, scene, motion_);
    return motion_.limits & hal::Bit(hal::Limit::kSingularity);
  }

  config::ServoConfig config_;
  VecN q_;
  double sigma_ = 0.0;
  model::ArmPoses poses_;
  model::Mat6N J_C_;
  model::LinearJacobian J_E_B_;
  trajectory::Reference reference_;
  MotionTask task_;
  ResolvedMotion motion_;
};

TEST_F(ResolveMotionTest, SingularityLimitsTheLawButNotAJointMotion) {
  ASSERT_LT(sigma_, 1.05 * config_.guard.singularity_min);
  EXPECT_NE(Resolve(false), 0U);
  EXPECT_EQ(Resolve(true), 0U);
  EXPECT_GT(motion_.dq.dot(VecN(task_.v)), 0.9 * task_.v.squaredNorm());
}

TEST_F(ResolveMotionTest, JointMotionResetsTheSingularityEstimate) {
  motion_.watch.sigma = 5.0;  // far from singular, as the arm was before
  Resolve(true);
  EXPECT_NE(Resolve(false), 0U);
}

// A joint motion that keeps all limits is passed on bit by bit; one that does not is changed.
TEST_F(ResolveMotionTest, JointMotionWithinTheLimitsIsPassedOnAsItIs) {
  std::mt19937_64 engine(20261128);
  std::uniform_real_distribution<double> speed(-0.6, 0.6);
  int kept = 0;
  int limited = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    for (Eigen::Index i = 0; i < 7; ++i) {
      task_.v[i] = speed(engine) * (trial % 2 == 0 ? 1.0 : 8.0);
    }
    Resolve(true);
    ASSERT_TRUE(motion_.finite);
    if (motion_.limits == 0) {
      ASSERT_EQ(motion_.dq, VecN(task_.v));
      ++kept;
    } else {
      ASSERT_GT((motion_.dq - VecN(task_.v)).norm(), 1e-9);
      ++limited;
    }
  }
  EXPECT_GT(kept, 200);
  EXPECT_GT(limited, 200);
}

// A law that is slow is slow in every joint: near a singular posture, a slow hand has fast joints.
TEST_F(ResolveMotionTest, ShareOfSpeedBoundsEveryJoint) {
  constexpr double kShare = 0.25;
  std::mt19937_64 engine(20261130);
  std::uniform_real_distribution<double> speed(-4.0, 4.0);
  double most = 0.0;
  for (int trial = 0; trial < 500; ++trial) {
    for (Eigen::Index i = 0; i < 7; ++i) {
      task_.v[i] = speed(engine);
    }
    MotionScene scene{reference_, poses_, J_E_B_, J_C_};
    scene.speed_share = kShare;
    ResolveMotion(config_, task_, scene, motion_);
    for (int i = 0; i < 7; ++i) {
      const double dq_max =
          config_.guard.joint_velocity_fraction * config_.arm.joints[static_cast<std::size_t>(i)].dq_max;
      most = std::max(most, std::fabs(motion_.dq[i]) / dq_max);
    }
  }
  EXPECT_LE(most, kShare + 1e-9);
  EXPECT_GT(most, kShare - 1e-9);
}

TEST_F(ResolveMotionTest, JointMotionThatIsNotFiniteIsSaid) {
  task_.v[3] = std::numeric_limits<double>::quiet_NaN();
  Resolve(true);
  EXPECT_FALSE(motion_.finite);
  EXPECT_TRUE(motion_.dq.allFinite());
}

// With all limits in force at once no row is dropped: planes and boxes far away change nothing.
TEST_F(ResolveMotionTest, AllPlanesAndBoxesLeaveRoomForTheOtherLimits) {
  config_.guard.view = {true, -0.6, 0.6, -0.5, 0.5, 0.5};
  features::TargetOutline outline;
  outline.p_OP.fill(model::Vec3::Zero());
  outline.radius = 0.04;
  barriers::ViewedTarget target{outline, {}, J_C_};
  target.seen.X_CO.p = model::Vec3(0.0, 0.0, 0.4);
  target.normal_C = model::Vec3(std::sqrt(1.0 - 0.51 * 0.51), 0.0, 0.51);  // nearly at the tilt limit
  barriers::MotionLimits tilt;
  tilt.dq_min.setConstant(7, -1.0);
  tilt.dq_max.setConstant(7, 1.0);
  tilt.Add(barriers::DiscTiltBarrier(config_.guard, target.seen.X_CO.p, target.normal_C, J_C_));
  ASSERT_EQ(tilt.num_rows, 1);
  task_.v = 0.3 * tilt.rows[0].a.normalized();
  MotionScene scene{reference_, poses_, J_E_B_, J_C_};
  scene.target = &target;

  ResolveMotion(config_, task_, scene, motion_);
  const VecN few = motion_.dq;
  EXPECT_NE(motion_.limits & hal::Bit(hal::Limit::kFieldOfView), 0U);
  EXPECT_TRUE(tilt.KeptBy(0.999 * few));

  config::Obstacles& obstacles = config_.guard.obstacles;
  obstacles.num_planes = obstacles.num_boxes = config::Obstacles::kMost;
  obstacles.planes.fill({model::Vec3::UnitZ(), -9.0});
  obstacles.boxes.fill({model::Vec3(8.0, 8.0, 8.0), model::Vec3(9.0, 9.0, 9.0)});
  motion_ = {};
  ResolveMotion(config_, task_, scene, motion_);
  EXPECT_EQ(motion_.dq, few);
  EXPECT_TRUE(tilt.KeptBy(0.999 * motion_.dq));
}

}  // namespace
}  // namespace fovea::control
