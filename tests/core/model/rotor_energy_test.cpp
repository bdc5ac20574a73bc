// SPDX-License-Identifier: Apache-2.0
// Mass matrix and inverse dynamics of an arm with rotors, against its kinetic energy. The energy comes from
// finite differences of the links' poses and from the rotors' speeds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::model {
namespace {

ArmModel PandaWithRotors() {
  ArmModel arm = test::Panda().model;
  for (int i = 0; i < arm.num_joints; ++i) {
    arm.joints[static_cast<std::size_t>(i)].rotor_inertia = 0.6 / (1.0 + i);
  }
  return arm;
}

// A rotor turns with its joint; `rotor_inertia` contains the gear's ratio squared.
double KineticEnergy(const ArmModel& arm, const VecN& q, const VecN& dq) {
  constexpr double kStep = 1e-4;  // [s]
  ArmPoses before;
  ArmPoses now;
  ArmPoses after;
  ComputePoses(arm, q - kStep * dq, before);
  ComputePoses(arm, q, now);
  ComputePoses(arm, q + kStep * dq, after);
  double energy = 0.0;
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const LinkInertia& link = arm.links[k];
    const Vec3 v = (after.X_BL[k] * link.p_LiCom - before.X_BL[k] * link.p_LiCom) / (2.0 * kStep);
    const Mat3 W_L = now.X_BL[k].R.transpose() * (after.X_BL[k].R - before.X_BL[k].R) / (2.0 * kStep);
    const Vec3 w_L(0.5 * (W_L(2, 1) - W_L(1, 2)), 0.5 * (W_L(0, 2) - W_L(2, 0)),
                   0.5 * (W_L(1, 0) - W_L(0, 1)));
    energy += 0.5 * link.mass * v.squaredNorm() + 0.5 * w_L.dot(link.I_Com_Li * w_L) +
              0.5 * arm.joints[k].rotor_inertia * dq[i] * dq[i];
  }
  return energy;
}

TEST(RotorEnergy, GivesTheMassMatrix) {
  const ArmModel arm = PandaWithRotors();
  test::RandomStates random(17);
  double worst = 0.0;
  for (int state = 0; state < 20; ++state) {
    const VecN q = random.Position(arm);
    ArmPoses poses;
    ArmDynamics dynamics;
    ComputePoses(arm, q, poses);
    ComputeDynamics(arm, poses, VecN::Zero(7), dynamics);
    const auto energy = [&](int i, int j) {
      VecN dq = VecN::Zero(7);
      dq[i] = 1.0;
      dq[j] = 1.0;
      return KineticEnergy(arm, q, dq);
    };
    for (int i = 0; i < 7; ++i) {
      worst = std::max(worst, std::fabs(2.0 * energy(i, i) - dynamics.M(i, i)));
      for (int j = 0; j < i; ++j) {
        worst = std::max(worst, std::fabs(energy(i, j) - energy(i, i) - energy(j, j) - dynamics.M(i, j)));
      }
    }
  }
  std::cout << "M differs by at most " << worst << " kg m^2\n";
  EXPECT_LT(worst, 1e-7);
}

// Without gravity, the torques' power is the change of the energy.
TEST(RotorEnergy, ChangesByThePowerOfTheTorques) {
  ArmModel arm = PandaWithRotors();
  arm.g_B.setZero();
  test::RandomStates random(18);
  double worst = 0.0;
  double largest = 0.0;
  for (int state = 0; state < 50; ++state) {
    const VecN q = random.Position(arm);
    const VecN dq = random.Joints(arm, 2.0);
    const VecN ddq = random.Joints(arm, 10.0);
    ArmPoses poses;
    VecN tau;
    ComputePoses(arm, q, poses);
    InverseDynamics(arm, poses, dq, ddq, tau);
    const auto energy = [&](double t) {
      return KineticEnergy(arm, q + t * dq + 0.5 * t * t * ddq, dq + t * ddq);
    };
    constexpr double kStep = 1e-4;
    const double power = (energy(kStep) - energy(-kStep)) / (2.0 * kStep);
    worst = std::max(worst, std::fabs(power - tau.dot(dq)));
    largest = std::max(largest, std::fabs(power));
  }
  std::cout << "powers up to " << largest << " W differ by at most " << worst << " W\n";
  EXPECT_GT(largest, 20.0);
  EXPECT_LT(worst, 1e-4);
}

}  // namespace
}  // namespace fovea::model
