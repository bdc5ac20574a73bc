// SPDX-License-Identifier: Apache-2.0
// The view of a target after camera and target have moved, for the differences that L_s is compared with.
// Rotations use Eigen's exponential.
#pragma once

#include <Eigen/Geometry>

#include "firmware/core/features/feature_state.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::test {

inline model::Mat3 Turned(const model::Vec3& phi) {
  return phi.norm() > 0.0 ? Eigen::AngleAxisd(phi.norm(), phi.normalized()).toRotationMatrix()
                          : Eigen::Matrix3d::Identity();
}

// The view after `dt` [s] with the camera's body twist `V_BC_C` and the target's own motion.
inline features::TargetInCamera AfterSteps(const features::TargetInCamera& seen, const model::Vec6& V_BC_C,
                                           double dt) {
  const model::Pose camera{Turned(V_BC_C.tail<3>() * dt), V_BC_C.head<3>() * dt};
  const model::Pose moved{Turned(seen.w_BO_C * dt) * seen.X_CO.R, seen.X_CO.p + dt * seen.v_BO_C};
  return {camera.Inverse() * moved, seen.v_BO_C, seen.w_BO_C};
}

// A random view in front of the camera: tilted by up to `tilt` [rad] each way, any turn about its z axis.
inline features::TargetInCamera RandomView(RandomStates& random, double tilt) {
  features::TargetInCamera seen;
  const double z = random.Uniform(0.25, 1.2);
  seen.X_CO.p = {z * random.Uniform(-0.5, 0.5), z * random.Uniform(-0.4, 0.4), z};
  seen.X_CO.R = Turned({random.Uniform(-tilt, tilt), random.Uniform(-tilt, tilt), 0.0}) *
                Turned({0.0, 0.0, random.Uniform(-3.1, 3.1)});
  seen.v_BO_C = random.Vector(0.3);
  seen.w_BO_C = random.Vector(1.0);
  return seen;
}

inline model::Vec6 RandomTwist(RandomStates& random) {
  model::Vec6 V;
  V << random.Vector(0.5), random.Vector(1.0);
  return V;
}

// The largest relative difference of L_s V + ds/dt_target from the central difference of s. `Feature` has
// Compute(seen, state).
template <typename Feature>
double WorstDerivative(const Feature& feature, double tilt, unsigned seed, int poses) {
  RandomStates random(seed);
  double worst = 0.0;
  for (int k = 0; k < poses; ++k) {
    const features::TargetInCamera seen = RandomView(random, tilt);
    const model::Vec6 V = RandomTwist(random);
    features::FeatureState now, plus, minus;
    constexpr double kDt = 1e-5;
    if (!feature.Compute(seen, now) || !feature.Compute(AfterSteps(seen, V, kDt), plus) ||
        !feature.Compute(AfterSteps(seen, V, -kDt), minus)) {
      return 1e9;  // none of these may be refused
    }
    const Eigen::VectorXd difference = (plus.s - minus.s) / (2.0 * kDt);
    const Eigen::VectorXd computed = now.L_s * V + now.ds_dt_target;
    worst = std::max(worst, (computed - difference).norm() / std::max(1.0, difference.norm()));
  }
  return worst;
}

}  // namespace fovea::test
