// The shortest stop, by the derivatives of the way that it claims, and what the proof refuses.
#include "fovea/servo/stop_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fovea/model/kinematics.hpp"
#include "support/panda.hpp"
#include "support/random_states.hpp"

namespace fovea::servo {
namespace {

TEST(PlanStopTest, ComesToRestWithinItsLimits) {
  test::RandomStates random(61);
  double worst_start = 0.0;
  double worst_end = 0.0;
  double worst_a = 0.0;
  double worst_jerk = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double a_max = random.Uniform(1.0, 15.0);
    const double jerk = random.Uniform(50.0, 5000.0);
    const double dq = random.Uniform(-2.0, 2.0);
    const double ddq = random.Uniform(-a_max, a_max);
    const JointStop stop = PlanStop(dq, ddq, a_max, jerk);
    const double T = stop.Duration();
    const auto x = [&](double t) { return StopTravel(stop, dq, ddq, t); };
    const double h = T / 500;
    const auto velocity = [&](double t) { return (x(t + h) - x(t - h)) / (2.0 * h); };
    const auto acceleration = [&](double t) { return (x(t + h) - 2.0 * x(t) + x(t - h)) / (h * h); };
    // A central difference of a cubic is off by jerk h^2 / 6 and jerk h.
    worst_start = std::max(worst_start, std::abs(velocity(h) - dq - ddq * h) - jerk * h * h);
    worst_end =
        std::max(worst_end, std::abs(x(T) - x(T + 10.0)) + std::abs(x(T) - x(T - h)) - jerk * h * h * h);
    double last = ddq;
    for (int i = 1; i < 500; ++i) {
      const double a = acceleration(i * h);
      worst_a = std::max(worst_a, std::abs(a) / a_max);
      worst_jerk = std::max(worst_jerk, std::abs(a - last) / h / jerk);
      last = a;
    }
  }
  std::cout << "starts off by " << worst_start << " rad/s, is not at rest by " << worst_end
            << " rad; largest use: acceleration " << worst_a << ", jerk " << worst_jerk << "\n";
  EXPECT_LE(worst_start, 0.0);
  EXPECT_LE(worst_end, 0.0);
  EXPECT_LE(worst_a, 1.0 + 1e-6);
  EXPECT_LE(worst_jerk, 1.0 + 1e-3);
}

TEST(PlanStopTest, AtRestItIsNothing) {
  const JointStop stop = PlanStop(0.0, 0.0, 5.0, 500.0);
  EXPECT_EQ(stop.Duration(), 0.0);
  EXPECT_EQ(StopTravel(stop, 0.0, 0.0, 1.0), 0.0);
}

TEST(LimitsPassedTest, NamesWhatAStopWouldPass) {
  const ServoConfig config = test::PandaConfig();
  Reference reference{test::Ready(), model::VecN::Zero(7), model::VecN::Zero(7)};
  const model::Vec3 kInside(0.5, 0.1, 0.4);
  EXPECT_EQ(LimitsPassed(config, reference, reference.q, kInside), 0U);
  // Joint 6 half a degree before its margin, at 1 rad/s.
  const model::Joint& joint = config.arm.joints[5];
  reference.q[5] = joint.q_max - config.guard.joint_position_margin - 0.01;
  reference.dq[5] = 1.0;
  EXPECT_EQ(LimitsPassed(config, reference, reference.q, kInside), hal::Bit(hal::Limit::kJointPosition));
  reference.dq[5] = -1.0;
  EXPECT_EQ(LimitsPassed(config, reference, reference.q, kInside), 0U);
  // A workspace that ends a centimetre before the end effector, towards which joint 2 leans out.
  reference = {test::Ready(), model::VecN::Zero(7), model::VecN::Zero(7)};
  model::ArmPoses poses;
  model::ComputePoses(config.arm, reference.q, poses);
  const double radius = poses.X_BE.p.norm();
  ServoConfig narrow = config;
  narrow.guard.workspace_radius = radius + narrow.guard.workspace_margin + 0.01;
  reference.dq[3] = 1.0;  // stretches the elbow
  EXPECT_EQ(LimitsPassed(narrow, reference, reference.q, poses.X_BE.p), hal::Bit(hal::Limit::kWorkspace));
  // The same with a plane and with a box a centimetre before it; away from them it may go.
  const model::Vec3& p = poses.X_BE.p;
  const model::Vec3 outward = p / radius;
  ServoConfig plane = config;
  plane.guard.obstacles.num_planes = 1;
  plane.guard.obstacles.planes[0] = {-outward, -(radius + plane.guard.workspace_margin + 0.01)};
  EXPECT_EQ(LimitsPassed(plane, reference, reference.q, p), hal::Bit(hal::Limit::kObstacle));
  ServoConfig box = config;
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
  EXPECT_EQ(LimitsPassed(box, reference, reference.q, p), hal::Bit(hal::Limit::kObstacle));
  reference.dq[3] = -1.0;
  EXPECT_EQ(LimitsPassed(plane, reference, reference.q, p), 0U);
  EXPECT_EQ(LimitsPassed(box, reference, reference.q, p), 0U);
}

}  // namespace
}  // namespace fovea::servo
