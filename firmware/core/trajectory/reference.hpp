// SPDX-License-Identifier: Apache-2.0
// The joints' reference, which the motion law follows. Continuous in q, dq and ddq.
#pragma once

#include "firmware/core/model/types.hpp"

namespace fovea::trajectory {

struct Reference {
  model::VecN q;    // [num_joints]
  model::VecN dq;   // [num_joints]
  model::VecN ddq;  // [num_joints]

  // At rest: it may stay here for ever without a jump. Real-time: yes.
  [[nodiscard]] bool IsAtRest() const noexcept {
    constexpr double kAtRest = 1e-6;  // [rad/s, rad/s^2]
    return dq.lpNorm<Eigen::Infinity>() <= kAtRest && ddq.lpNorm<Eigen::Infinity>() <= kAtRest;
  }
};

}  // namespace fovea::trajectory
