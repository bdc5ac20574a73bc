// SPDX-License-Identifier: Apache-2.0
// The contact observer on an arm that follows its model, moving and pushed.
#include "firmware/core/estimate/contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>
#include <span>

#include "firmware/core/motion_laws/motion_law.hpp"
#include "tests/support/ideal_arm.hpp"
#include "tests/support/panda.hpp"

namespace fovea::estimate {
namespace {

constexpr double kGain = 30.0;  // [1/s]

// Swings all joints by computed torque; `push` [Nm] acts on each after 1 s. Returns the residual [Nm].
model::VecN Observed(double push, double& worst_before) {
  const config::ServoConfig config = test::PandaConfig();
  test::IdealArm arm(config.arm, test::Ready());
  motion_laws::MotionLawState law;
  law.Reset(config::MotionLawKind::kComputedTorque, 7);
  ContactState contact;
  contact.Reset(7, true);
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
    trajectory::Reference reference;
    reference.q = test::Ready();
    reference.q.array() += 0.3 * (1.0 - std::cos(3.0 * t));
    reference.dq.setConstant(7, 0.9 * std::sin(3.0 * t));
    reference.ddq.setConstant(7, 2.7 * std::cos(3.0 * t));
    motion_laws::MotionLaw(config.motion_law, {config.arm, poses, dynamics, reference, arm.q(), arm.dq()},
                           law, tau);
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

TEST(ContactTest, ResidualEqualsThePushAndIsNearZeroWithoutOne) {
  double worst_before = 0.0;
  const model::VecN r = Observed(2.0, worst_before);
  std::cout << "in motion and untouched " << worst_before << " Nm at most; pushed with 2 Nm " << r.transpose()
            << "\n";
  EXPECT_LT(worst_before, 0.01);
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(r[i], 2.0, 0.005);
  }
}

// An arm in the ready posture with `push` [Nm] on each joint from the start. If `carries`, the servo
// compensates this load until `lays_down_s`, then fades it out.
class PushedArm {
 public:
  PushedArm(double push, bool carries, double lays_down_s)
      : push_(push), carries_(carries), lays_down_s_(lays_down_s) {
    law_.Reset(config::MotionLawKind::kComputedTorque, 7);
    contact_.Reset(7, true);
    reference_.q = test::Ready();
    reference_.dq.setZero(7);
    reference_.ddq.setZero(7);
  }

  // From now on the encoders hang at their present values, plus noise [rad], [rad/s].
  void HangsWithNoise(double q_noise, double dq_noise) {
    q_hung_ = arm_.q();
    q_noise_ = q_noise;
    dq_noise_ = dq_noise;
    hangs_ = true;
  }

  // Runs until `t_s`. Returns the deflection of the joints [rad].
  model::VecN OffAt(double t_s) {
    for (; 1e-3 * tick_ < t_s; ++tick_) {
      Tick();
    }
    return arm_.q() - reference_.q;
  }

  // Runs until `t_s`. Returns the mean torque [Nm].
  model::VecN TorqueUntil(double t_s) {
    model::VecN sum = model::VecN::Zero(7);
    const int from = tick_;
    for (; 1e-3 * tick_ < t_s; ++tick_) {
      Tick();
      sum += tau_;
    }
    return sum / (tick_ - from);
  }

 private:
  void Tick() {
    model::VecN q = arm_.q();
    model::VecN dq = arm_.dq();
    for (int i = 0; hangs_ && i < 7; ++i) {
      q[i] = q_hung_[i] + q_noise_ * noise_(random_);
      dq[i] = dq_noise_ * noise_(random_);
    }
    model::ArmPoses poses;
    model::ArmDynamics dynamics;
    model::ComputePoses(config_.arm, q, poses);
    model::ComputeDynamics(config_.arm, poses, dq, dynamics);
    ObserveContact(config_.safety.contact_gain, dynamics, dq, tau_, contact_);
    motion_laws::MotionLaw(config_.motion_law, {config_.arm, poses, dynamics, reference_, q, dq}, law_, tau_);
    if (carries_) {
      const bool stands = 1e-3 * tick_ < lays_down_s_;
      const config::SafetyConfig& safety = config_.safety;
      CarryLoad({config_.arm, safety.stiction_fraction, safety.carried_torque_fraction, stands}, contact_,
                tau_);
    }
    hal::ArmCommand command;
    command.num_joints = 7;
    model::VecN acting = tau_;
    acting.array() += push_;
    command.tau_cmd = model::ToArray(acting);
    arm_.Apply(command);
    arm_.Step();
  }

  double push_;
  bool carries_;
  double lays_down_s_;
  config::ServoConfig config_ = test::PandaConfig();
  test::IdealArm arm_{config_.arm, test::Ready()};
  motion_laws::MotionLawState law_;
  trajectory::Reference reference_;
  ContactState contact_;
  model::VecN tau_ = model::VecN::Zero(7);
  int tick_ = 0;
  bool hangs_ = false;
  model::VecN q_hung_;
  double q_noise_ = 0.0;
  double dq_noise_ = 0.0;
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_;
};

// The largest share of `push` that the friction of a joint may hold.
double LeftToFriction(double push) {
  const config::ServoConfig config = test::PandaConfig();
  double left = 0.0;
  for (const model::Joint& joint : std::span(config.arm.joints).first(7)) {
    left = std::max(left, config.safety.stiction_fraction * joint.coulomb / push);
  }
  return left;
}

// Uncompensated joints deflect by M^-1 push / omega_n^2. The share that friction may hold is left to them.
TEST(CarryLoadTest, PushedArmSagsByAQuarterPlusTheFrictionShare) {
  const double push = 1.5;
  const model::VecN sags = PushedArm(push, false, 0.0).OffAt(2.0);
  const model::VecN stands = PushedArm(push, true, 1e9).OffAt(2.0);
  const double left = LeftToFriction(push);
  std::cout << "deflection without compensation " << sags.norm() << " rad, with it " << stands.norm()
            << " rad; share left to friction at most " << left << "\n";
  EXPECT_GT(sags.norm(), 1e-3);
  EXPECT_LT(left, 0.5);
  EXPECT_LT(stands.norm(), (0.25 + 0.75 * left + 0.01) * sags.norm());
}

// A load that friction may hold is not compensated: friction and compensation would hunt each other.
TEST(CarryLoadTest, LoadBelowStictionIsNotCarried) {
  const config::ServoConfig config = test::PandaConfig();
  double least = HUGE_VAL;
  for (const model::Joint& joint : std::span(config.arm.joints).first(7)) {
    least = std::min(least, config.safety.stiction_fraction * joint.coulomb);
  }
  ASSERT_GT(least, 0.0);
  EXPECT_EQ(PushedArm(0.5 * least, true, 1e9).OffAt(1.0), PushedArm(0.5 * least, false, 0.0).OffAt(1.0));
}

// When the arm is to move, the compensation fades within a quarter of a second: the load is not dropped.
TEST(CarryLoadTest, CarriedLoadIsReleasedSlowly) {
  PushedArm arm(1.5, true, 1.0);
  const model::VecN carried = arm.OffAt(1.0);
  const double all = (PushedArm(1.5, false, 0.0).OffAt(2.0) - carried).norm();
  const double soon = (arm.OffAt(1.05) - carried).norm() / all;
  const double in_the_end = (arm.OffAt(1.6) - carried).norm() / all;
  std::cout << "share of the full deflection: after 50 ms " << soon << ", in the end " << in_the_end << "\n";
  EXPECT_LT(soon, 0.1);
  EXPECT_NEAR(in_the_end, 1.0, 0.01);
}

// The compensation must not press a hand between arm and wall harder and harder.
TEST(CarryLoadTest, CarriedTorqueIsCappedAtItsLimit) {
  const config::ServoConfig config = test::PandaConfig();
  const double most = config.safety.carried_torque_fraction;
  ASSERT_LE(most, 0.5 * config.safety.contact_torque_fraction);
  for (const double push : {-1e3, 1e3}) {
    ContactState contact;
    contact.Reset(7, true);
    contact.residual.setConstant(7, push);
    model::VecN tau = model::VecN::Zero(7);
    CarryLoad({config.arm, config.safety.stiction_fraction, most, true}, contact, tau);
    for (int i = 0; i < 7; ++i) {
      const double tau_max = config.arm.joints[static_cast<std::size_t>(i)].tau_max;
      EXPECT_DOUBLE_EQ(tau[i], std::copysign(most * tau_max, -push));
    }
  }
}

// With encoders that hang, every torque looks like a push. The compensating torque must then stay constant.
TEST(CarryLoadTest, StuckEncodersFreezeTheCarriedTorque) {
  PushedArm arm(1.5, true, 1e9);
  arm.OffAt(1.5);
  const model::VecN before = arm.TorqueUntil(2.0);
  arm.HangsWithNoise(5e-5, 5e-4);
  double worst = 0.0;
  for (const double t_s : {3.0, 4.0, 6.0, 8.0, 12.0}) {
    worst = std::max(worst, (arm.TorqueUntil(t_s) - before).cwiseAbs().maxCoeff());
  }
  std::cout << "torque before " << before.transpose() << " Nm; changed by at most " << worst << " Nm\n";
  EXPECT_LT(worst, 0.05);
}

}  // namespace
}  // namespace fovea::estimate
