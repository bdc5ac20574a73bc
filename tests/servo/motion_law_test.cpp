// The partition law on an arm that obeys the model: each joint's error lives by e'' + k_v' e' + k_p' e = 0.
#include "fovea/servo/motion_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "support/ideal_arm.hpp"
#include "support/panda.hpp"
#include "support/random_states.hpp"

namespace fovea::servo {
namespace {

hal::ArmCommand CommandOf(const model::VecN& tau) {
  hal::ArmCommand command;
  command.num_joints = static_cast<int>(tau.size());
  command.tau_cmd = model::ToArray(tau);
  return command;
}

TEST(MotionLawTest, ErrorsDecayCriticallyDampedInEveryJoint) {
  const ServoConfig config = test::PandaConfig();
  test::IdealArm arm(config.arm, test::Ready());
  Reference reference;
  model::VecN error(7);
  error << 0.10, -0.08, 0.06, 0.05, -0.10, 0.07, 0.09;
  reference.q = test::Ready() + error;
  reference.dq = model::VecN::Zero(7);
  reference.ddq = model::VecN::Zero(7);
  const double w = config.motion_law.omega_n;
  double worst = 0.0;
  for (int tick = 0; tick < 600; ++tick) {
    const double t = 1e-3 * tick;
    // Critically damped from rest: e(t) = e0 (1 + w t) exp(-w t).
    const model::VecN expected = error * ((1.0 + w * t) * std::exp(-w * t));
    worst = std::max(worst, (reference.q - arm.q() - expected).cwiseAbs().maxCoeff());
    model::ArmPoses poses;
    model::ArmDynamics dynamics;
    model::ComputePoses(config.arm, arm.q(), poses);
    model::ComputeDynamics(config.arm, poses, arm.dq(), dynamics);
    model::VecN tau;
    MotionLaw(config.motion_law, dynamics, reference, arm.q(), arm.dq(), tau);
    arm.Apply(CommandOf(tau));
    arm.Step();
  }
  std::cout << "worst departure from the analytic error: " << worst << " rad of "
            << error.cwiseAbs().maxCoeff() << " rad\n";
  EXPECT_LT(worst, 2e-3);  // the hold of 1 ms delays the loop
}

TEST(MotionLawTest, DampedStopTakesTheSpeedAwayExponentially) {
  const ServoConfig config = test::PandaConfig();
  test::IdealArm arm(config.arm, test::Ready());
  model::VecN start(7);
  start << 0.5, -0.4, 0.6, 0.5, -0.7, 0.4, 0.8;
  arm.SetVelocity(start);
  double energy_before = HUGE_VAL;
  for (int tick = 0; tick < 500; ++tick) {
    model::ArmPoses poses;
    model::ArmDynamics dynamics;
    model::ComputePoses(config.arm, arm.q(), poses);
    model::ComputeDynamics(config.arm, poses, arm.dq(), dynamics);
    const double energy = 0.5 * arm.dq().dot(dynamics.M * arm.dq());
    EXPECT_LT(energy, energy_before) << "it never speeds up";
    energy_before = energy;
    model::VecN tau;
    DampedStop(config.safety.fault_damping, dynamics, arm.dq(), tau);
    arm.Apply(CommandOf(tau));
    arm.Step();
  }
  EXPECT_LT(arm.dq().norm(), start.norm() * std::exp(-0.5 * config.safety.fault_damping) * 2.0);
}

}  // namespace
}  // namespace fovea::servo
