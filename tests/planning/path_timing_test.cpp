// SPDX-License-Identifier: Apache-2.0
// The timing of paths, against the time-optimal straight move of firmware/core/trajectory.
#include <gtest/gtest.h>

#include <cstdio>

#include "firmware/core/trajectory/joint_move.hpp"
#include "tests/planning/free_space.hpp"

namespace fovea {
namespace {

using planning::JointLimits;
using planning::Polyline;
using planning::SmoothPath;
using trajectory::Plan;
using trajectory::Reference;

// In the middle of the joints' ranges, where their ends slow nothing down.
model::VecN MiddlePosture(const model::ArmModel& arm, test::RandomStates& random) {
  model::VecN q(arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double middle = 0.5 * (joint.q_min + joint.q_max);
    q[i] = middle + 0.25 * (joint.q_max - joint.q_min) * random.Uniform(-1.0, 1.0);
  }
  return q;
}

TEST(PathTiming, AStraightMotionTakesLittleLongerThanTheOptimum) {
  const config::ServoConfig config = test::FreeServo();
  const JointLimits limits = planning::LimitsOfPlan(config);
  test::RandomStates random(2);
  double most_later = 0.0;
  double least_later = HUGE_VAL;
  for (int k = 0; k < 200; ++k) {
    Reference start;
    start.q = MiddlePosture(config.arm, random);
    start.dq.setZero(7);
    start.ddq.setZero(7);
    const model::VecN goal = MiddlePosture(config.arm, random);
    trajectory::JointMove optimum;
    ASSERT_TRUE(optimum.Plan(start, goal, limits));
    const Plan plan = test::TimedPlan(config, test::Line(start.q, goal));
    ASSERT_TRUE(plan.IsSound());
    most_later = std::max(most_later, plan.Duration() - optimum.Duration());
    least_later = std::min(least_later, plan.Duration() - optimum.Duration());
    Reference end;
    plan.At(plan.Duration(), end);
    EXPECT_EQ((end.q - goal).lpNorm<Eigen::Infinity>(), 0.0);
  }
  std::printf("%.3f to %.3f s later than the optimum\n", least_later, most_later);
  EXPECT_GE(least_later, 0.0);
  EXPECT_LE(most_later, 0.25);
}

TEST(PathTiming, ACurvedMotionStaysOnItsPathAndWithinAllLimits) {
  const config::ServoConfig config = test::FreeServo();
  const JointLimits limits = planning::LimitsOfPlan(config);
  test::RandomStates random(3);
  double off_path = 0.0;
  double share = 0.0;
  for (int k = 0; k < 50; ++k) {
    Polyline corners = test::Line(MiddlePosture(config.arm, random), MiddlePosture(config.arm, random));
    const Polyline more = test::Line(corners.back(), MiddlePosture(config.arm, random));
    corners.insert(corners.end(), more.begin() + 1, more.end());
    const Plan plan = test::TimedPlan(config, corners);
    ASSERT_TRUE(plan.IsSound());
    const SmoothPath path(corners);
    Reference at;
    Reference last;
    plan.At(0.0, last);
    double u = 0.0;
    for (double t = 1e-3; t < plan.Duration(); t += 1e-3) {
      plan.At(t, at);
      // The nearest place on the path, from the last one on.
      double off = (path.At(u) - at.q).norm();
      for (double next = u; next < u + 0.5; next += 1e-3) {
        if (const double there = (path.At(next) - at.q).norm(); there < off) {
          off = there;
          u = next;
        }
      }
      off_path = std::max(off_path, off);
      for (int j = 0; j < 7; ++j) {
        const trajectory::AxisLimits& limit = limits[static_cast<std::size_t>(j)];
        share = std::max({share, std::fabs(at.dq[j]) / limit.v_max, std::fabs(at.ddq[j]) / limit.a_max,
                          std::fabs(at.ddq[j] - last.ddq[j]) / 1e-3 / limit.j_max});
      }
      last = at;
    }
  }
  std::printf("%.2f mrad off the path, %.6f of the limits\n", 1e3 * off_path, share);
  EXPECT_LE(off_path, 0.012);
  EXPECT_LE(share, 1.0 + 1e-9);
  EXPECT_GE(share, 0.99);
}

TEST(PathTiming, ASmoothPathHasAContinuousDirection) {
  test::RandomStates random(4);
  const config::ServoConfig config = test::FreeServo();
  Polyline corners;
  for (int i = 0; i < 12; ++i) {
    corners.push_back(MiddlePosture(config.arm, random));
  }
  const SmoothPath path(corners);
  EXPECT_EQ((path.At(0.0) - corners.front()).norm(), 0.0);
  EXPECT_EQ((path.At(path.End()) - corners.back()).norm(), 0.0);
  double slope_off = 0.0;
  double bend_off = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double u = random.Uniform(0.01, path.End() - 0.01);
    constexpr double kStep = 1e-6;
    slope_off = std::max(slope_off,
                         ((path.At(u + kStep) - path.At(u - kStep)) / (2.0 * kStep) - path.Slope(u)).norm());
    if (std::fabs(u + 0.5 - std::round(u + 0.5)) > 2.0 * kStep) {
      bend_off = std::max(
          bend_off, ((path.Slope(u + kStep) - path.Slope(u - kStep)) / (2.0 * kStep) - path.Bend(u)).norm());
    }
  }
  std::printf("slope off by %.1e, bend by %.1e\n", slope_off, bend_off);
  EXPECT_LT(slope_off, 1e-5);
  EXPECT_LT(bend_off, 1e-8);
}

}  // namespace
}  // namespace fovea
