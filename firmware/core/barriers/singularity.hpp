// SPDX-License-Identifier: Apache-2.0
// The distance of the arm from a singular posture, its gradient, and a motion limit made from both.
//
// The measure is the smallest singular value sigma of the body Jacobian with its linear rows divided by a
// length, so that metres and radians are comparable. It is the hand's speed in its slowest direction, for
// joint velocities of norm 1. Its gradient is dsigma/dq_k = u^T (dJ/dq_k) v with the singular vectors u, v of
// sigma and dJ/dq from the Jacobian's own columns. If the two smallest singular values are equal, sigma has a
// kink, and the gradient is that of one branch. At sigma = 0, where sigma = |a smooth function|, the gradient
// is returned as 0.
#pragma once

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

struct SingularityConfig {
  double length = 0.3;      // this distance counts as much as one radian [m]
  double sigma_min = 0.05;  // lower bound of sigma
  double rate = 5.0;        // sigma - sigma_min shrinks no faster than exp(-rate t) [1/s]
};

struct Singularity {
  double sigma = 0.0;    // of J with its linear rows divided by the length
  model::VecN gradient;  // [num_joints] dsigma/dq [1/rad]
};

// `J` [6 x num_joints] body Jacobian of any frame fixed to the end effector. For an arm with fewer than six
// joints, sigma is the smallest of the num_joints singular values. Real-time: yes.
void ComputeSingularity(const model::Mat6N& J, double length, Singularity& singularity) noexcept;

// Saves computing time: the joints' speed bounds how fast sigma changes, so that far from a singularity sigma
// need not be computed in each tick.
struct SingularityWatch {
  static constexpr double kNear = 0.3;  // the limit applies if sigma is less than this above sigma_min

  double sigma = 0.0;  // last computed value, less the largest possible decrease since
};

// Call once per tick. `speed`: sum of the joints' speeds since the last call [rad/s]. `reach`: no point of
// the arm is further from a joint axis [m]. If the posture is near a singularity: true, with `singularity`
// computed. Real-time: yes.
bool IsNear(const SingularityConfig& config, const model::Mat6N& J, double speed, double reach,
            SingularityWatch& watch, Singularity& singularity) noexcept;

// h is sigma, with the margin sigma_min. Standing still is always allowed. Real-time: yes.
[[nodiscard]] Barrier SingularityBarrier(const SingularityConfig& config,
                                         const Singularity& singularity) noexcept;

}  // namespace fovea::barriers
