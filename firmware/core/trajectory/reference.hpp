// SPDX-License-Identifier: Apache-2.0
// The joints' reference, which the motion law follows. Continuous in q, dq and ddq.
#pragma once

#include "firmware/core/model/types.hpp"

namespace fovea::trajectory {

struct Reference {
  model::VecN q;    // [num_joints]
  model::VecN dq;   // [num_joints]
  model::VecN ddq;  // [num_joints]
};

}  // namespace fovea::trajectory
