// The observer against an arm that obeys the model, moving and pushed.
#include "fovea/servo/contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "fovea/servo/motion_law.hpp"
#include "support/ideal_arm.hpp"
#include "support/panda.hpp"

namespace fovea::servo {
namespace {

constexpr double kGain = 30.0;  // [1/s]

// Swings all joints by computed torque, with `push` on each of them from the second on; what is observed.
model::VecN Observed(double push, double& worst_before) {
  const ServoConfig config = test::PandaConfig();
  test::IdealArm arm(config.arm, test::Ready());
  MotionLawState law;
  law.Reset(MotionLawKind::kComputedTorque, 7);
  ContactState contact;
  model::VecN tau = model::VecN::Zero(7);
  worst_before = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    model::ArmPoses poses;
    model::ArmDynamics dynamics;
    model::ComputePoses(config.arm, arm.q(), poses);
    model::ComputeDynamics(config.arm, poses, arm.dq(), dynamics);
    ObserveContact(kGain, dynamics, arm.dq(), tau, contact);
    if (tick < 1000) {
      worst_before = std::max(worst_before, contact.residual.cwiseAbs().maxCoeff());
    }
    const double t = 1e-3 * tick;
    Reference reference;
    reference.q = test::Ready();
    reference.q.array() += 0.3 * (1.0 - std::cos(3.0 * t));
    reference.dq.setConstant(7, 0.9 * std::sin(3.0 * t));
    reference.ddq.setConstant(7, 2.7 * std::cos(3.0 * t));
    MotionLaw(config.motion_law, {config.arm, poses, dynamics, reference, arm.q(), arm.dq()}, law, tau);
    hal::ArmCommand command;
    command.num_joints = 7;
    model::VecN acting = tau;
    acting.array() += tick < 1000 ? 0.0 : push;
    command.tau_cmd = model::ToArray(acting);
    arm.Apply(command);
    arm.Step();
  }
  return contact.residual;
}

TEST(ContactTest, SeesWhatPushesAndNothingElse) {
  double worst_before = 0.0;
  const model::VecN r = Observed(2.0, worst_before);
  std::cout << "in motion and untouched " << worst_before << " Nm at most; pushed with 2 Nm " << r.transpose()
            << "\n";
  EXPECT_LT(worst_before, 0.01);
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(r[i], 2.0, 0.005);
  }
}

}  // namespace
}  // namespace fovea::servo
