// SPDX-License-Identifier: Apache-2.0
// Which known causes explain the torques that a simulated arm lacks.
//
// The torques are linear in the unknowns of each cause: a joint's friction follows the sign and the size of
// its speed, its rotor the acceleration, a load gravity and acceleration at the hand on all joints together,
// a delay the rate of the torques, a bias nothing. Causes are added one by one, each time the one that
// explains most for its number of unknowns (Schwarz, Estimating the dimension of a model, 1978), for one
// joint or for all; then those that have become superfluous are left out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/fovea/compare/player.hpp"

namespace fovea::compare {

enum class Cause : std::uint8_t { kFriction, kRotor, kBias, kLoad, kDelay };
inline constexpr int kCauses = 5;

// Of one joint. Values are true less simulated; 0 where a cause is not at work.
struct JointCauses {
  std::array<double, kCauses> share{};  // of the sum of squares that each cause explains, 0 to 1
  double coulomb = 0.0;                 // [Nm, N]
  double viscous = 0.0;                 // [Nm s/rad, N s/m]
  double rotor = 0.0;                   // [kg m^2, kg]
  double bias = 0.0;                    // [Nm, N]
};

struct Causes {
  std::vector<JointCauses> joints;
  double mass = 0.0;                         // of the load [kg]
  model::Vec3 moment = model::Vec3::Zero();  // mass times distance from the believed centre, in E [kg m]
  double delay_s = 0.0;
};

// `tau_max` [Nm, N]: each joint's largest torque; the accuracy of the data follows from it.
[[nodiscard]] Causes FindCauses(const std::vector<Lack>& windows, const std::vector<double>& tau_max);

// The part of a window's torques that the causes explain [Nm, N].
[[nodiscard]] model::VecN Explained(const Causes& causes, const Lack& window);

}  // namespace fovea::compare
