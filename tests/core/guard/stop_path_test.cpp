// SPDX-License-Identifier: Apache-2.0
// The proof of a stop: the limits that it names, and its verdict against that from all points of the path.
#include "firmware/core/guard/stop_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "firmware/core/barriers/links_barrier.hpp"
#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/barriers/self_clearance_barrier.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/trajectory/velocity_change.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::guard {
namespace {

// The verdict without any knowledge.
hal::LimitSet PassedFrom(const config::ServoConfig& config, const trajectory::Reference& next,
                         const model::VecN& q_now) {
  model::LazyPoses now(config.arm, q_now);
  KnownClearances known;
  return LimitsPassed(config, next, now, known);
}

TEST(LimitsPassedTest, NamesEveryLimitThatAStopWouldPass) {
  const config::ServoConfig config = test::PandaConfig();
  trajectory::Reference reference{test::Ready(), model::VecN::Zero(7), model::VecN::Zero(7)};
  model::ArmPoses poses;
  model::ComputePoses(config.arm, reference.q, poses);
  EXPECT_EQ(PassedFrom(config, reference, reference.q), 0U);
  // Joint 6 half a degree before its margin, at 1 rad/s. Away from there, it swings the hand outwards.
  config::ServoConfig wide = config;
  wide.guard.workspace_radius = 2.0;
  const model::Joint& joint = config.arm.joints[5];
  reference.q[5] = joint.q_max - config.guard.joint_position_margin - 0.01;
  reference.dq[5] = 1.0;
  EXPECT_EQ(PassedFrom(wide, reference, reference.q), hal::Bit(hal::Limit::kJointPosition));
  reference.dq[5] = -1.0;
  EXPECT_EQ(PassedFrom(wide, reference, reference.q), 0U);
  // The workspace ends 1 cm (and its margin) beyond the end effector. Joint 4 moves the hand towards it.
  reference = {test::Ready(), model::VecN::Zero(7), model::VecN::Zero(7)};
  model::ComputePoses(config.arm, reference.q, poses);
  const double radius = poses.X_BE.p.norm();
  config::ServoConfig narrow = config;
  narrow.guard.workspace_radius = radius + narrow.guard.workspace_margin + 0.01;
  reference.dq[3] = 1.0;  // stretches the elbow
  EXPECT_EQ(PassedFrom(narrow, reference, reference.q), hal::Bit(hal::Limit::kWorkspace));
  // The same with a plane and with a box 1 cm ahead. Motion away from them is allowed.
  const model::Vec3& p = poses.X_BE.p;
  const model::Vec3 outward = p / radius;
  config::ServoConfig plane = config;
  plane.guard.obstacles.num_planes = 1;
  plane.guard.obstacles.planes[0] = {-outward, -(radius + plane.guard.workspace_margin + 0.01)};
  EXPECT_EQ(PassedFrom(plane, reference, reference.q), hal::Bit(hal::Limit::kObstacle));
  config::ServoConfig box = config;
  box.guard.obstacles.num_boxes = 1;
  model::LinearJacobian J_E_B;
  model::ComputeLinearJacobian(config.arm, poses, p, J_E_B);
  int axis = 0;
  J_E_B.col(3).cwiseAbs().maxCoeff(&axis);
  const model::Vec3 way = std::copysign(1.0, J_E_B(axis, 3)) * model::Vec3::Unit(axis);
  const model::Vec3 face = p + (box.guard.workspace_margin + 0.01) * way;
  const model::Vec3 across = model::Vec3::Ones() - model::Vec3::Unit(axis);
  box.guard.obstacles.boxes[0] = {(face - across).cwiseMin(face + across + way),
                                  (face - across).cwiseMax(face + across + way)};
  EXPECT_EQ(PassedFrom(box, reference, reference.q), hal::Bit(hal::Limit::kObstacle));
  reference.dq[3] = -1.0;
  EXPECT_EQ(PassedFrom(plane, reference, reference.q), 0U);
  EXPECT_EQ(PassedFrom(box, reference, reference.q), 0U);
}

// The verdict equals that from all points of the path, near bounds and far from them.
TEST(LimitsPassedTest, SampledStopGivesTheSameVerdictAsAllPoints) {
  test::RandomStates random(9);
  config::ServoConfig config = test::PandaConfig();
  config.guard.obstacles.num_planes = 1;
  config.guard.obstacles.planes[0] = {{0.0, 0.0, 1.0}, 0.1};
  ASSERT_TRUE(config.guard.hand.AddCapsule(model::Vec3::Zero(), {0.05, 0.0, 0.15}, 0.03));
  int num_passed = 0;
  constexpr int kCases = 20'000;
  for (int k = 0; k < kCases; ++k) {
    const double pace = k % 3 == 0 ? 0.1 : 1.0;  // of the joints: a slow arm is often clear of all bounds
    model::VecN q_now = test::Ready();
    trajectory::Reference next{q_now, model::VecN::Zero(7), model::VecN::Zero(7)};
    for (int i = 0; i < 7; ++i) {
      const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
      q_now[i] += random.Uniform(-0.9, 0.9);
      next.dq[i] = pace * random.Uniform(-1.0, 1.0) * joint.dq_max;
      next.ddq[i] = pace * random.Uniform(-0.7, 0.7) * joint.ddq_max;
      next.q[i] = q_now[i] + 1e-3 * next.dq[i];
    }
    model::ArmPoses poses;
    model::ComputePoses(config.arm, q_now, poses);
    const model::Vec3 p_now = poses.X_BE.p;
    const hal::LimitSet passed = PassedFrom(config, next, q_now);
    if (passed == hal::Bit(hal::Limit::kJointPosition)) {
      continue;
    }
    double duration = 0.0;
    std::array<trajectory::VelocityChange, 7> stops;
    for (int i = 0; i < 7; ++i) {
      const auto j = static_cast<std::size_t>(i);
      const model::Joint& joint = config.arm.joints[j];
      stops[j] = trajectory::PlanVelocityChange(
          next.dq[i], next.ddq[i], 0.0,
          {joint.dq_max, config.guard.joint_acceleration_fraction * joint.ddq_max,
           config.guard.joint_jerk_fraction * joint.dddq_max});
      duration = std::max(duration, stops[j].Duration());
    }
    duration += 1e-3;
    const double boundary =
        std::max(config.guard.workspace_radius - config.guard.workspace_margin, p_now.norm()) + 1e-9;
    const auto bounds = [&](const model::ArmPoses& at) {
      const barriers::ArmBodies bodies = barriers::PlaceBodies(config.arm, at);
      return std::array{
          barriers::ClearanceOf(config.guard.obstacles, 0, config.guard.hand, at.X_BE).clearance.distance,
          barriers::ClearanceOfLinks(config.guard.obstacles, 0, bodies, HUGE_VAL),
          barriers::SelfClearance(config.arm, bodies)};
    };
    const std::array least{config.guard.workspace_margin,
                           config.guard.link_clearance + config.guard.workspace_margin,
                           config.guard.self_clearance - 0.01};
    const auto now = bounds(poses);
    bool expected = false;
    for (int sample = 0; sample < kStopSamples && !expected; ++sample) {
      const double share = static_cast<double>(sample) / (kStopSamples - 1);
      model::VecN q = next.q + 1e-3 * next.dq;
      model::VecN dq = next.dq;
      for (int i = 0; i < 7; ++i) {
        const trajectory::AxisState state = stops[static_cast<std::size_t>(i)].At(duration * share * share);
        q[i] += state.x;
        dq[i] = state.v;
      }
      model::ComputePoses(config.arm, q, poses);
      model::LinearJacobian J;
      model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J);
      const bool too_fast =
          (J * dq).norm() > 0.94 * config.guard.cartesian_speed ||
          model::AngularVelocity(config.arm, poses, dq).norm() > 0.90 * config.guard.rotation_speed;
      expected = poses.X_BE.p.norm() > boundary || too_fast;
      const auto then = bounds(poses);
      for (std::size_t i = 0; i < then.size(); ++i) {
        expected = expected || then[i] < std::min(least[i], now[i]) - 1e-9;
      }
    }
    ASSERT_EQ(passed != 0, expected) << "case " << k;
    num_passed += expected ? 1 : 0;
  }
  std::cout << num_passed << " of " << kCases << " exceed a bound\n";
  EXPECT_GT(num_passed, kCases / 10);
  EXPECT_LT(num_passed, kCases * 9 / 10);
}

// What earlier proofs leave changes no verdict, and most proofs need nothing else. Arms that wander from
// random starts, with wishes that change now and then, near a bench and far from it.
TEST(LimitsPassedTest, KnownClearancesChangeNoVerdict) {
  test::RandomStates random(11);
  config::ServoConfig config = test::PandaConfig();
  config.guard.obstacles.num_planes = 1;
  config.guard.obstacles.planes[0] = {{0.0, 0.0, 1.0}, 0.1};
  ASSERT_TRUE(config.guard.hand.AddCapsule(model::Vec3::Zero(), {0.05, 0.0, 0.15}, 0.03));
  int num_passed = 0;
  int num_looks = 0;
  int num_cases = 0;
  for (int arm = 0; arm < 100; ++arm) {
    KnownClearances known;
    model::VecN q = test::Ready();
    model::VecN dq = model::VecN::Zero(7);
    model::VecN wish = dq;
    for (int i = 0; i < 7; ++i) {
      q[i] += random.Uniform(-0.7, 0.7);
    }
    for (int tick = 0; tick < 400; ++tick) {
      if (tick % 80 == 0) {
        for (int i = 0; i < 7; ++i) {
          const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
          wish[i] = random.Uniform(-0.6, 0.6) * (arm % 2 == 0 ? 0.3 : 1.0) * joint.dq_max;
        }
      }
      trajectory::Reference next;
      next.ddq = 5.0 * (wish - dq);
      next.dq = dq + 1e-3 * next.ddq;
      next.q = q + 1e-3 * next.dq;
      const model::VecN last = known.last().q;
      model::LazyPoses now(config.arm, q);
      const hal::LimitSet passed = LimitsPassed(config, next, now, known);
      ASSERT_EQ(passed, PassedFrom(config, next, q)) << "arm " << arm << ", tick " << tick;
      num_passed += passed != 0 ? 1 : 0;
      num_looks += last.size() == 0 || (known.last().q - last).norm() > 0.0 ? 1 : 0;
      ++num_cases;
      q = next.q;
      dq = next.dq;
    }
  }
  std::cout << num_passed << " of " << num_cases << " exceed a bound, " << num_looks << " leave more\n";
  EXPECT_GT(num_passed, num_cases / 20);
  EXPECT_LT(num_passed, num_cases / 8);
  EXPECT_LT(num_looks, num_cases / 5);
}

}  // namespace
}  // namespace fovea::guard
