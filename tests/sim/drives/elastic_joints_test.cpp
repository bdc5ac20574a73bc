// SPDX-License-Identifier: Apache-2.0
// Elastic joints against the two-mass oscillator: frequency, damping, energy, static deflection, friction
// that holds, and the limit of a stiff spring.
#include "sim/drives/elastic_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <stdexcept>

#include "fovea/hal/types.hpp"
#include "sim/physics/bullet_arm.hpp"
#include "tests/support/places.hpp"

namespace fovea::sim {
namespace {

constexpr double kTick = hal::kTickPeriodS;

Eigen::VectorXd One(double value) { return Eigen::VectorXd::Constant(1, value); }

// A link of constant inertia on a motor, in steps as the physics makes them.
struct TwoMasses {
  TwoMasses(double stiffness, double damping, double motor, double link, double holding = 0.0)
      : joint({One(stiffness), One(damping), One(motor), One(holding)}), inertia(link) {}

  void Step(double tau_motor, double tau_link) {
    joint.Step(One(tau_motor), One(dq), One(tau_link / inertia),
               Eigen::MatrixXd::Constant(1, 1, 1.0 / inertia), kTick);
    dq += kTick * (tau_link + joint.torque()[0]) / inertia;
    q += kTick * dq;
  }
  [[nodiscard]] double Energy() const { return joint.Energy() + 0.5 * inertia * dq * dq; }

  ElasticJoints joint;
  double inertia;
  double q = 0.0;
  double dq = 0.0;
};

// Two masses on a spring swing with sqrt(K (1 / B + 1 / I)).
TEST(ElasticJoints, SwingWithTheFrequencyOfTwoMasses) {
  for (const double stiffness : {1e2, 1e3, 1e4, 1e5}) {
    constexpr double kMotor = 0.6;
    constexpr double kLink = 0.4;
    const double omega = std::sqrt(stiffness * (1.0 / kMotor + 1.0 / kLink));
    TwoMasses swing(stiffness, 0.0, kMotor, kLink);
    swing.joint.Settle(One(5.0), One(0.0));  // let go from this torque
    // The phase of the deflection, unwound from tick to tick.
    double turned = 0.0;
    double before = 0.0;
    constexpr int kTicks = 2000;
    for (int n = 0; n < kTicks; ++n) {
      swing.Step(0.0, 0.0);
      const double rate = swing.joint.motor_speed()[0] - swing.dq;
      const double phase = std::atan2(-rate / omega, swing.joint.deflection()[0]);
      turned += std::remainder(phase - before, 2.0 * std::numbers::pi);
      before = phase;
    }
    const double measured = turned / (kTicks * kTick);
    std::cout << stiffness << " Nm/rad: " << measured << " rad/s, by theory " << omega << "\n";
    // The midpoint rule turns by 2 atan(x / 2) instead of x, at most kMostTurn.
    EXPECT_NEAR(measured / omega, 1.0, ElasticJoints::kMostTurn * ElasticJoints::kMostTurn / 12.0);
  }
}

TEST(ElasticJoints, KeepTheirEnergyWithoutDamping) {
  for (const double stiffness : {1e2, 1e4, 1e6, 1e9}) {
    TwoMasses swing(stiffness, 0.0, 0.2, 0.005);
    swing.joint.Settle(One(1.0), One(0.0));
    swing.dq = 0.3;
    const double start = swing.Energy();
    double drift = 0.0;
    for (int n = 0; n < 5000; ++n) {
      swing.Step(0.0, 0.0);
      drift = std::max(drift, std::fabs(swing.Energy() / start - 1.0));
    }
    std::cout << stiffness << " Nm/rad: energy changes by at most " << drift << " relative in 5 s\n";
    EXPECT_LT(drift, 1e-9);
  }
}

// dd of the damped swing decays with D (1 / B + 1 / I) / 2.
// The whole arm swings freely: semi-implicit Euler moves its links, and loses what it loses without springs.
TEST(ElasticJoints, APandaKeepsItsEnergy) {
  const SimRobot robot = LoadSimRobot(test::RobotsFolder() + "/panda.urdf", "panda_base", "panda_flange");
  for (const double stiffness : {1e3, 1e4, 1e6}) {
    BulletArm arm(robot, {.table = false, .gravity = false});
    const auto all = [](double value) { return Eigen::VectorXd(Eigen::VectorXd::Constant(7, value)); };
    ElasticJoints joints({all(stiffness), all(0.0), all(0.4), all(0.0)});
    Eigen::VectorXd q(7);
    Eigen::VectorXd dq(7);
    q << 0.0, -0.5, 0.3, -1.8, 0.2, 1.5, 0.4;
    dq << 0.5, -0.4, 0.6, 0.5, -0.7, 0.4, 0.8;
    arm.SetState(q, dq);
    joints.Settle(all(2.0), dq);
    const double start = arm.Energy() + joints.Energy();
    double drift = 0.0;
    for (int n = 0; n < 5000; ++n) {
      const Eigen::VectorXd ddq = arm.ForwardDynamics(all(0.0));
      joints.Step(all(0.0), arm.dq(), ddq, arm.InverseMass(), kTick);
      arm.Step(joints.torque(), kTick);
      drift = std::max(drift, std::fabs((arm.Energy() + joints.Energy()) / start - 1.0));
    }
    std::cout << stiffness << " Nm/rad: a Panda's energy changes by at most " << 100.0 * drift
              << " % in 5 s\n";
    EXPECT_LT(drift, 0.03);
  }
}

TEST(ElasticJoints, DampingTakesTheEnergyThatItShould) {
  constexpr double kPerInertia = 1.0 / 0.6 + 1.0 / 0.4;
  const double omega = std::sqrt(1e4 * kPerInertia);
  const double zeta = 0.05;
  TwoMasses swing(1e4, 2.0 * zeta * omega / kPerInertia, 0.6, 0.4);
  swing.joint.Settle(One(5.0), One(0.0));
  const double start = swing.Energy();
  constexpr int kTicks = 100;
  double before = start;
  for (int n = 0; n < kTicks; ++n) {
    swing.Step(0.0, 0.0);
    EXPECT_LE(swing.Energy(), before * (1.0 + 1e-12));
    before = swing.Energy();
  }
  const double rate = -std::log(before / start) / (kTicks * kTick);
  std::cout << "energy decays with " << rate << " 1/s, by theory " << 2.0 * zeta * omega << "\n";
  EXPECT_NEAR(rate / (2.0 * zeta * omega), 1.0, 0.05);  // it swings about the exponential
}

TEST(ElasticJoints, RestWithTheStaticDeflection) {
  for (const double stiffness : {1e2, 1e4, 1e6}) {
    // The link is pulled, the motor holds against it.
    TwoMasses swing(stiffness, std::sqrt(stiffness), 0.6, 0.4);
    for (int n = 0; n < 5000; ++n) {
      swing.Step(7.0, -7.0);
    }
    std::cout << stiffness << " Nm/rad under 7 Nm: " << swing.joint.deflection()[0] << " rad\n";
    EXPECT_NEAR(swing.joint.deflection()[0], 7.0 / stiffness, 1e-9 * 7.0 / stiffness + 1e-15);
    EXPECT_NEAR(swing.joint.torque()[0], 7.0, 1e-8);
  }
}

// The stiffer, the nearer to one body: deviations fall like 1 / K.
TEST(ElasticJoints, GoToOneBodyAsTheStiffnessGrows) {
  double before = 0.0;
  for (const double stiffness : {1e3, 1e4, 1e5, 1e6, 1e9}) {
    TwoMasses swing(stiffness, 0.0, 0.6, 0.4);
    double q = 0.0;
    double dq = 0.0;
    double worst = 0.0;
    for (int n = 0; n < 1000; ++n) {
      const double tau = 3.0 * std::sin(0.02 * n);
      swing.Step(tau, 0.0);
      dq += kTick * tau;
      q += kTick * dq;
      worst = std::max(worst, std::fabs(swing.q - q));
    }
    std::cout << stiffness << " Nm/rad: at most " << worst << " rad from one body\n";
    if (before > 0.0 && stiffness <= 1e6) {
      EXPECT_LT(worst, 0.15 * before);
    }
    before = worst;
  }
  EXPECT_LT(before, 5e-7) << "the swing of the stiffest spring is too fast for its steps, but stays small";
}

// Any stiffness and damping within the keys' ranges, on the lightest wrist.
TEST(ElasticJoints, AreStableAtOneKilohertzWhateverTheStiffness) {
  for (double stiffness = 100.0; stiffness <= 1e9; stiffness *= 10.0) {
    for (const double damping : {0.0, 1.0, 1e3, 1e6}) {
      for (const double motor : {1e-4, 0.2, 10.0}) {
        for (const double holding : {0.0, 0.5}) {
          TwoMasses swing(stiffness, damping, motor, 0.001, holding);
          swing.joint.Settle(One(5.0), One(0.0));
          const double start = swing.Energy();
          for (int n = 0; n < 1000; ++n) {
            swing.Step(0.0, 0.0);
          }
          EXPECT_LE(swing.Energy(), start * (1.0 + 1e-9)) << stiffness << " " << damping << " " << motor;
        }
      }
    }
  }
}

TEST(ElasticJoints, FrictionHoldsAMotorUpToItsSize) {
  TwoMasses held(1e4, 100.0, 0.6, 0.4, 2.0);
  for (int n = 0; n < 3000; ++n) {
    held.Step(0.0, 1.9);
  }
  EXPECT_NEAR(held.joint.motor_speed()[0], 0.0, 1e-15) << "the link leans on the spring of a motor at rest";
  EXPECT_NEAR(held.joint.deflection()[0], -1.9 / 1e4, 1e-9);
  for (int n = 0; n < 1000; ++n) {
    held.Step(0.0, 2.3);
  }
  EXPECT_NEAR(held.dq, 0.3 * 1.0, 0.01) << "the rest of the torque accelerates both masses for 1 s";
}

TEST(ElasticJoints, RefuseWhatCannotBe) {
  EXPECT_THROW(ElasticJoints({One(0.0), One(0.0), One(1.0), One(0.0)}), std::invalid_argument);
  EXPECT_THROW(ElasticJoints({One(1.0), One(-1.0), One(1.0), One(0.0)}), std::invalid_argument);
  EXPECT_THROW(ElasticJoints({One(1.0), One(0.0), One(0.0), One(0.0)}), std::invalid_argument);
  EXPECT_THROW(ElasticJoints({One(1.0), One(0.0), One(1.0), One(-1.0)}), std::invalid_argument);
}

}  // namespace
}  // namespace fovea::sim
