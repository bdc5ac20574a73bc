// SPDX-License-Identifier: Apache-2.0
// Motion laws on an ideal arm. With the partition law each joint's error obeys e'' + k_v' e' + k_p' e = 0.
#include "firmware/core/motion_laws/motion_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <optional>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/motion_laws/friction.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"
#include "tests/support/ideal_arm.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::motion_laws {
namespace {

hal::ArmCommand CommandOf(const model::VecN& tau) {
  hal::ArmCommand command;
  command.num_joints = static_cast<int>(tau.size());
  command.tau_cmd = model::ToArray(tau);
  return command;
}

// A motion law and an ideal arm in closed loop. Tick: one step; `push` [Nm] acts on every joint.
class Loop {
 public:
  Loop(const config::ServoConfig& config, const model::VecN& q) : config_(config), arm_(config.arm, q) {
    state_.Reset(config.motion_law.kind, config.arm.num_joints);
  }

  const model::VecN& Tick(const trajectory::Reference& reference, double push = 0.0) {
    model::ComputePoses(config_.arm, arm_.q(), poses_);
    model::ComputeDynamics(config_.arm, poses_, arm_.dq(), dynamics_);
    const MotionLawInputs inputs{config_.arm, poses_, dynamics_, reference, arm_.q(), arm_.dq()};
    if (change_) {
      ChangeMotionLaw(config_.motion_law, inputs, *change_, state_);
      change_.reset();
    }
    MotionLaw(config_.motion_law, inputs, state_, tau_);
    model::VecN acting = tau_;
    acting.array() += push;
    arm_.Apply(CommandOf(acting));
    arm_.Step();
    return tau_;
  }
  void Change(config::MotionLawKind kind) { change_ = kind; }
  test::IdealArm& arm() { return arm_; }
  MotionLawState& state() { return state_; }
  const model::ArmDynamics& dynamics() const { return dynamics_; }

 private:
  config::ServoConfig config_;
  test::IdealArm arm_;
  MotionLawState state_;
  model::ArmPoses poses_;
  model::ArmDynamics dynamics_;
  model::VecN tau_;
  std::optional<config::MotionLawKind> change_;
};

trajectory::Reference Standing(const model::VecN& q) {
  trajectory::Reference r;
  r.q = q;
  r.dq.setZero(q.size());
  r.ddq.setZero(q.size());
  return r;
}

// The Panda with the stiffness and damping that the keys derive from omega_n and zeta.
config::ServoConfig Config(config::MotionLawKind kind) {
  config::ServoConfig config = test::PandaConfig();
  config.motion_law.kind = kind;
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::ComputePoses(config.arm, test::Ready(), poses);
  model::ComputeDynamics(config.arm, poses, model::VecN::Zero(7), dynamics);
  for (int i = 0; i < 7; ++i) {
    const auto k = static_cast<std::size_t>(i);
    config.motion_law.k_p[k] = dynamics.M(i, i) * config.motion_law.omega_n * config.motion_law.omega_n;
    config.motion_law.k_v[k] = 2.0 * std::sqrt(config.motion_law.k_p[k] * dynamics.M(i, i));
  }
  return config;
}

// A swing of all joints that starts from rest at `q`.
trajectory::Reference Swing(const model::VecN& q, double t) {
  const double w = 2.0;
  const model::VecN a = model::VecN::Constant(q.size(), 0.15);
  trajectory::Reference r;
  r.q = q + a * (1.0 - std::cos(w * t));
  r.dq = a * (w * std::sin(w * t));
  r.ddq = a * (w * w * std::cos(w * t));
  return r;
}

TEST(MotionLawTest, ErrorsDecayCriticallyDampedInEveryJoint) {
  const config::ServoConfig config = test::PandaConfig();
  Loop loop(config, test::Ready());
  model::VecN error(7);
  error << 0.10, -0.08, 0.06, 0.05, -0.10, 0.07, 0.09;
  const trajectory::Reference reference = Standing(test::Ready() + error);
  const double w = config.motion_law.omega_n;
  double worst = 0.0;
  for (int tick = 0; tick < 600; ++tick) {
    const double t = 1e-3 * tick;
    // Critically damped from rest: e(t) = e0 (1 + w t) exp(-w t).
    const model::VecN expected = error * ((1.0 + w * t) * std::exp(-w * t));
    worst = std::max(worst, (reference.q - loop.arm().q() - expected).cwiseAbs().maxCoeff());
    loop.Tick(reference);
  }
  std::cout << "worst departure from the analytic error: " << worst << " rad of "
            << error.cwiseAbs().maxCoeff() << " rad\n";
  EXPECT_LT(worst, 2e-3);  // the hold of 1 ms delays the loop
}

// The end effector's error decays alike in all six directions, whatever the arm's inertia.
TEST(MotionLawTest, OperationalSpaceDecouplesTheEndEffector) {
  const config::ServoConfig config = Config(config::MotionLawKind::kOperationalSpace);
  Loop loop(config, test::Ready());
  model::VecN error(7);
  error << 0.03, -0.02, 0.02, 0.03, -0.03, 0.02, 0.04;
  const trajectory::Reference reference = Standing(test::Ready() + error);
  const auto position = [&](const model::VecN& q) {
    model::ArmPoses poses;
    model::ComputePoses(config.arm, q, poses);
    return poses.X_BE.p;
  };
  const model::Vec3 e_0 = position(reference.q) - position(test::Ready());
  const double w = config.motion_law.omega_n;
  double worst = 0.0;
  for (int tick = 0; tick < 600; ++tick) {
    const double t = 1e-3 * tick;
    const model::Vec3 expected = e_0 * ((1.0 + w * t) * std::exp(-w * t));
    worst = std::max(worst, (position(reference.q) - position(loop.arm().q()) - expected).norm());
    loop.Tick(reference);
  }
  std::cout << "worst departure from the analytic error: " << 1e3 * worst << " mm of " << 1e3 * e_0.norm()
            << " mm; posture at the end off by " << (reference.q - loop.arm().q()).norm() << " rad\n";
  EXPECT_LT(worst, 0.01 * e_0.norm());
  EXPECT_LT((reference.q - loop.arm().q()).norm(), 1e-5) << "the posture follows in the null space";
}

TEST(MotionLawTest, ModelBasedLawsFollowASwing) {
  for (const config::MotionLawKind kind :
       {config::MotionLawKind::kComputedTorque, config::MotionLawKind::kJointImpedance,
        config::MotionLawKind::kOperationalSpace, config::MotionLawKind::kPd}) {
    const config::ServoConfig config = Config(kind);
    Loop loop(config, test::Ready());
    double worst = 0.0;
    for (int tick = 0; tick < 3000; ++tick) {
      const trajectory::Reference reference = Swing(test::Ready(), 1e-3 * tick);
      worst = std::max(worst, (reference.q - loop.arm().q()).cwiseAbs().maxCoeff());
      loop.Tick(reference);
    }
    const MotionLawEntry& law = kMotionLaws[static_cast<std::size_t>(kind)];
    EXPECT_EQ(law.kind, kind);
    std::cout << config::kMotionLawNames[static_cast<std::size_t>(law.kind)] << " follows within " << worst
              << " rad\n";
    EXPECT_LT(worst, kind == config::MotionLawKind::kPd ? 5e-3 : 2e-5);
  }
}

// Under a constant torque the impedance law gives way by tau / k_p.
TEST(MotionLawTest, ImpedanceYieldsByTorqueOverStiffness) {
  config::ServoConfig config = Config(config::MotionLawKind::kJointImpedance);
  config.motion_law.k_p.fill(50.0);
  Loop loop(config, test::Ready());
  for (int tick = 0; tick < 6000; ++tick) {
    loop.Tick(Standing(test::Ready()), 1.0);
  }
  const model::VecN given = loop.arm().q() - test::Ready();
  std::cout << "gives way by " << given.transpose() << " rad\n";
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(given[i], 1.0 / 50.0, 1e-4);
  }
}

TEST(MotionLawTest, IntegralStopsAtItsBoundAndPausesWhileClamped) {
  config::ServoConfig config = test::PandaConfig();
  config.motion_law.integral = 5.0;
  config.motion_law.integral_torque_fraction = 0.1;
  Loop loop(config, test::Ready());
  // The arm is jammed away from its goal.
  loop.arm().Jam();
  const trajectory::Reference reference = Standing(test::Ready() + model::VecN::Constant(7, 0.05));
  const double k_p = config.motion_law.omega_n * config.motion_law.omega_n;
  for (int tick = 0; tick < 5000; ++tick) {
    loop.Tick(reference);
  }
  for (int i = 0; i < 7; ++i) {
    const double most = 0.1 * config.arm.joints[static_cast<std::size_t>(i)].tau_max;
    const double torque =
        config.motion_law.integral * k_p * loop.state().integral[i] * loop.dynamics().M(i, i);
    EXPECT_NEAR(torque, most, 1e-9) << "joint " << i;
  }
  // While the clamp cuts the torque, the integral pauses.
  Loop cut(config, test::Ready());
  cut.arm().Jam();
  for (int tick = 0; tick < 100; ++tick) {
    cut.state().cut.setConstant(7, 1.0);
    cut.Tick(reference);
  }
  EXPECT_EQ(cut.state().integral.norm(), 0.0);
}

// From any law to any other, in motion and under a push: no torque step above the arm's rate limit.
TEST(MotionLawTest, LawChangeCausesNoTorqueStep) {
  double worst = 0.0;
  for (const MotionLawEntry& from : kMotionLaws) {
    for (const MotionLawEntry& to : kMotionLaws) {
      config::ServoConfig config = Config(from.kind);
      config.motion_law.integral = 1.0;
      Loop loop(config, test::Ready());
      model::VecN before = model::VecN::Zero(7);
      for (int tick = 0; tick < 900; ++tick) {
        if (tick == 400) {
          loop.Change(to.kind);
        }
        // A floating arm is not pushed: it would be far away by then.
        const bool floats = from.kind == config::MotionLawKind::kFloat;
        const trajectory::Reference reference =
            floats ? Standing(loop.arm().q()) : Swing(test::Ready(), 1e-3 * tick);
        const model::VecN tau = loop.Tick(reference, floats ? 0.0 : 0.3);
        if (tick > 10) {
          for (int i = 0; i < 7; ++i) {
            const double most = config.arm.joints[static_cast<std::size_t>(i)].dtau_max * 1e-3;
            worst = std::max(worst, std::fabs(tau[i] - before[i]) / most);
          }
        }
        before = tau;
      }
      EXPECT_EQ(loop.state().kind, to.kind);
    }
  }
  std::cout << "largest step of a torque: " << worst << " of what the arm allows in a tick\n";
  EXPECT_LT(worst, 1.0);
}

// Each law has its own bound. For springs the joint with the fastest damping counts.
TEST(MotionLawTest, GainsThatDampTooFastDoNotFit) {
  for (const auto& [kind, most] : {std::pair{config::MotionLawKind::kComputedTorque, 400.0},
                                   {config::MotionLawKind::kOperationalSpace, 400.0},
                                   {config::MotionLawKind::kPd, 75.0},
                                   {config::MotionLawKind::kJointImpedance, 75.0}}) {
    for (const double share : {0.99, 1.01}) {
      config::ServoConfig config = Config(kind);
      config.motion_law.zeta = 0.5 * share * most / config.motion_law.omega_n;
      for (double& k_v : config.motion_law.k_v) {
        k_v *= config.motion_law.zeta;
      }
      const Fitness fitness = FitnessOf(config.motion_law, config.arm, kind);
      EXPECT_EQ(fitness.why, share < 1.0 ? Unfit::kNone : Unfit::kDampedTooFast);
      EXPECT_NEAR(fitness.damping, share * most, 1e-9);
    }
  }
  config::ServoConfig config = Config(config::MotionLawKind::kPd);
  config.motion_law.k_v[4] *= 2.0;
  const Fitness fitness = FitnessOf(config.motion_law, config.arm, config::MotionLawKind::kPd);
  EXPECT_EQ(fitness.why, Unfit::kDampedTooFast);
  EXPECT_EQ(fitness.joint, 4);
  config.arm.num_joints = 5;
  EXPECT_EQ(FitnessOf(config.motion_law, config.arm, config::MotionLawKind::kOperationalSpace).why,
            Unfit::kTooFewJoints);
}

TEST(MotionLawTest, FrictionIsCompensatedWithoutChatter) {
  model::ArmModel arm = test::PandaConfig().arm;
  for (model::Joint& joint : arm.joints) {
    joint.viscous = 2.0;
    joint.coulomb = 5.0;
  }
  config::MotionLawConfig config;
  config.friction_compensation = 1.0;
  config.friction_width = 1e-3;
  trajectory::Reference reference = Standing(test::Ready());
  const auto torque = [&](double wanted, double measured) {
    reference.dq.setConstant(wanted);
    return FrictionTorque(arm, config, reference, model::VecN::Constant(7, measured))[3];
  };
  EXPECT_NEAR(torque(0.5, 0.5), 2.0 * 0.5 + 5.0, 1e-4);
  EXPECT_NEAR(torque(-0.5, -0.5), -2.0 * 0.5 - 5.0, 1e-4);
  EXPECT_EQ(torque(0.0, 0.0), 0.0) << "no torque at standstill";
  EXPECT_NEAR(torque(0.1, 0.0), 5.0, 1e-2) << "the full torque breaks a standing joint loose";
  // Encoder noise at standstill hardly changes the torque.
  for (const double noise : {-5e-4, 5e-4}) {
    EXPECT_LT(std::fabs(torque(0.0, noise)), 0.01);
  }
}

}  // namespace
}  // namespace fovea::motion_laws
