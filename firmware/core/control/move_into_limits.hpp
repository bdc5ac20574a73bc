// SPDX-License-Identifier: Apache-2.0
// The joint velocity that keeps all limits and is nearest to a wish:
//
//   minimise  (dq - dq_wish)^T H (dq - dq_wish)   subject to  dq_min <= dq <= dq_max,  a_k^T dq <= b_k
//
// with H symmetric positive definite: the cost of a departure from the wish. Solved by the dual active-set
// method (Goldfarb and Idnani, A numerically stable dual method for solving strictly convex quadratic
// programs, 1983): the solver starts at the wish and adds limits one at a time, the most violated first. A
// wish that violates none costs one check of each; one that violates two takes about two steps. The result is
// exact to rounding, needs no initial guess, and is continuous in wish, H and limits.
#pragma once

#include <cstdint>

#include "firmware/core/barriers/motion_limits.hpp"

namespace fovea::control {

enum class LimitOutcome : std::uint8_t {
  kFree,     // the wish keeps all limits and is the result
  kLimited,  // the nearest velocity
  kScaled,   // unsolved in kMaxSteps or lost to rounding: last estimate, moved towards rest into the limits
  kInfeasible,  // no dq keeps all limits: as near to rest as the joints' ranges allow; rows may be violated
  kNotFinite,   // an argument is not finite; result as for kInfeasible
};

struct LimitedMotion {
  static constexpr int kMaxSteps = 60;  // 8 joints and 12 random rows take 7 on average, 36 at most

  model::VecN dq;  // [num_joints] finite; in the joints' ranges exactly, in the rows to within 1e-9 |a|
  LimitOutcome outcome = LimitOutcome::kFree;
  int steps = 0;            // of the solver
  std::uint32_t upper = 0;  // bit i: dq_max[i] holds dq back
  std::uint32_t lower = 0;  // bit i: dq_min[i] does
  std::uint32_t rows = 0;   // bit k: row k does
};

// `H` [num_joints x num_joints]: only the lower half is read. If dq_min > dq_max, the end nearer to zero
// counts as the range. Real-time: yes.
void MoveIntoLimits(const model::MatN& H, const model::VecN& dq_wish, const barriers::MotionLimits& limits,
                    LimitedMotion& motion) noexcept;

}  // namespace fovea::control
