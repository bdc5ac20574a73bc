// SPDX-License-Identifier: Apache-2.0
// Kinematic resolution without limits: from a wished task velocity to joint velocities.
//
//   dq = dq_0 + J^# (v - J dq_0)            J^# = W^-1/2 Jw^T g(Jw Jw^T),   Jw = J W^-1/2
//
// J^# is the weighted pseudo-inverse, damped in each singular direction on its own: with sigma the
// direction's singular value and t = sigma / threshold,
//
//   1 / g = sigma^2                                  for t >= 1: exact
//   1 / g = sigma^2 + (threshold (1 - t^2) / 2)^2    for t <  1: damping that grows smoothly from 0
//
// Well-conditioned directions stay exact beside ill-conditioned ones, and |W^1/2 J^# v| <= 1.3 |v| /
// threshold. dq is a smooth function of J even where singular values meet or vanish, because it depends on
// the matrix and not on its singular vectors. dq_0 acts as (I - J^# J) dq_0: exactly in the null space while
// t >= 1 for all directions; otherwise it disturbs the task by at most 0.22 threshold |W^1/2 dq_0|.
//
// (Nakamura and Hanafusa, Inverse kinematic solutions with singularity robustness, 1986; Chiaverini,
// Singularity-robust task-priority redundancy resolution, 1997; Maciejewski and Klein, Numerical filtering
// for the operation of robotic manipulators through kinematically singular configurations, 1988.)
#pragma once

#include "firmware/core/barriers/row_svd.hpp"
#include "firmware/core/model/ldlt.hpp"
#include "firmware/core/model/symmetric_axes.hpp"

namespace fovea::control {

struct MotionTask {
  barriers::TaskJacobian J;   // [dim x num_joints]
  features::FeatureVector v;  // [dim] wished J dq
  model::VecN dq_0;           // [num_joints] wish for the directions that the task leaves free
  model::VecN weight;         // [num_joints] diagonal of W, > 0: a heavy joint moves less
};

struct DampingConfig {
  double threshold = 0.05;        // damping begins at this singular value, relative to the rms one of Jw
  double threshold_floor = 1e-6;  // lower bound of the threshold, in units of Jw; > 0
};

struct DampedMotion {
  model::VecN dq;          // [num_joints]
  double threshold = 0.0;  // below which a singular value of Jw is damped
  double sigma_min = 0.0;  // smallest singular value of Jw, or `threshold` if it is not below that
  bool finite = false;     // false: an argument was not finite, or dq overflowed; dq = 0
};

// J^# of one task, for any number of wishes. A = Jw Jw^T gives singular values to 1e-8 of the largest one,
// far below any useful threshold.
class DampedInverse {
 public:
  // Uses J and weight of `task`. Real-time: yes.
  DampedInverse(const DampingConfig& config, const MotionTask& task) noexcept;

  // The joint velocities for v and dq_0 of `task`, whose J and weight are the same as before. Real-time: yes.
  void Resolve(const MotionTask& task, DampedMotion& motion) const noexcept;

 private:
  template <std::size_t kRows>
  void Factor(const DampingConfig& config) noexcept;
  template <std::size_t kRows>
  void Apply(std::array<double, 8>& y) const noexcept;

  std::size_t rows_;
  std::size_t columns_;
  std::array<double, 8> shrink_{};  // [columns] diagonal of W^-1/2
  model::Square8 Jw_{};
  double threshold_ = 0.0;
  double sigma_min_ = 0.0;
  bool damped_ = false;
  model::Square8 factors_;        // of A, if nothing is damped
  model::SymmetricAxes axes_;     // axes of A, if something is damped
  std::array<double, 8> filter_;  // g along each axis
};

// Real-time: yes.
void ResolveDamped(const DampingConfig& config, const MotionTask& task, DampedMotion& motion) noexcept;

}  // namespace fovea::control
