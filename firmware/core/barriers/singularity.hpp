// How near the arm is to a singular posture, which way it comes nearer, and a limit on that.
//
// The measure is the smallest singular value sigma of the body Jacobian with its linear rows divided by a
// length, so that metres and radians compare: the slowest motion of the hand that joints of speed 1 can be
// brought to make. Its gradient is dsigma/dq_k = u^T (dJ/dq_k) v with the singular vectors u, v of sigma and
// dJ/dq from the Jacobian's own columns. Where the two smallest singular values meet, sigma has a kink, and
// the gradient is that of one of its branches; at sigma = 0, where sigma = |something smooth|, it is given as
// 0.
#pragma once

#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

struct SingularityConfig {
  double length = 0.3;      // that a metre counts as much as a radian for [m]
  double sigma_min = 0.05;  // the arm does not go deeper than this
  double rate = 5.0;        // what is left above it may be used up no faster than exp(-rate t) [1/s]
};

struct Singularity {
  double sigma = 0.0;    // of J with its linear rows divided by the length
  model::VecN gradient;  // [num_joints] dsigma/dq [1/rad]
};

// `J` [6 x num_joints] body Jacobian of any frame fixed to the end effector. Of an arm with fewer than six
// joints it is the smallest of its num_joints singular values. Real-time: yes.
void ComputeSingularity(const model::Mat6N& J, double length, Singularity& singularity) noexcept;

// Looks after the measure at the cost that it deserves: sigma changes no faster than the joints' speed
// allows, so that far from a singularity it need not be computed anew in each tick.
struct SingularityWatch {
  static constexpr double kNear = 0.3;  // the limit is looked at when sigma is this close to its least

  double sigma = 0.0;  // at the last look, less all that it may have lost since
};

// `speed`: sum of the joints' speeds since the last call [rad/s], in a tick; `reach`: no point of the arm is
// further from an axis [m]. True, with `singularity` computed, when the posture is near. Real-time: yes.
bool IsNear(const SingularityConfig& config, const model::Mat6N& J, double speed, double reach,
            SingularityWatch& watch, Singularity& singularity) noexcept;

// Its quantity is sigma, with the margin sigma_min: standing still is always allowed. Real-time: yes.
[[nodiscard]] Barrier SingularityBarrier(const SingularityConfig& config,
                                         const Singularity& singularity) noexcept;

}  // namespace fovea::barriers
