// SPDX-License-Identifier: Apache-2.0
// The records of a run of a Panda whose true calibration, load and friction are chosen: exact motion and
// torques, noise on readings and measurements, and no servo.
#pragma once

#include <functional>
#include <random>

#include "firmware/core/model/load.hpp"
#include "fovea/hal/record.hpp"
#include "tests/support/panda.hpp"

namespace fovea::test {

struct JointsNow {
  model::VecN q;
  model::VecN dq;
  model::VecN ddq;
};
using JointPath = std::function<JointsNow(double t_s)>;

// q = from + amplitude sin(multiple omega t) for each joint.
struct Waves {
  model::VecN from;
  model::VecN amplitude;
  model::VecN multiple;
  double omega = 1.0;

  [[nodiscard]] JointsNow operator()(double t_s) const;
};
// Turns the hand about several axes, both ways, over a ball at BallPlace().
[[nodiscard]] Waves LookAround();
[[nodiscard]] model::Vec3 BallPlace();

// The believed camera moves to and fro along `direction` (in B, of unit length), by `way` [m] to each side of
// the start of LookAround(), and does not turn.
[[nodiscard]] JointPath AlongALine(const config::ServoConfig& config, const model::Vec3& direction,
                                   double way, double omega, double duration_s);

// True values less the believed ones.
struct SyntheticTruth {
  double late = 0.0;                        // [s]
  model::Vec3 shift = model::Vec3::Zero();  // of the mount, in axes of C [m]
  model::Vec3 turn = model::Vec3::Zero();   // [rad]
  double focal = 0.0;                       // relative
  double size = 0.0;                        // relative
  model::Load load;
  model::VecN link_mass;  // relative, of each link; empty: 0
  model::VecN bias;       // of each joint's torque sensor [Nm]; empty: 0
  double viscous = 0.0;   // of every joint, not compensated [Nm s/rad]
  double coulomb = 0.0;   // [Nm]
};

struct SyntheticNoise {
  double sigma_px = 0.05;
  double position = 1e-5;  // [rad]
  double velocity = 5e-4;  // [rad/s]
};

// Calls `take` for each tick of `duration_s`. The camera takes 30 pictures a second; each arrives 40 ms after
// its stamp. `X_BO`: the target's true pose.
void MakeRun(const config::ServoConfig& config, const JointPath& path, const model::Pose& X_BO,
             const SyntheticTruth& truth, const SyntheticNoise& noise, double duration_s, unsigned seed,
             const std::function<void(const hal::TickRecord&)>& take);

}  // namespace fovea::test
