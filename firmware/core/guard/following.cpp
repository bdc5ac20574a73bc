// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/following.hpp"

#include <cmath>

namespace fovea::guard {

int JointThatDoesNotFollow(const config::SafetyConfig& config, const model::VecN& q_reference,
                           const model::VecN& q) noexcept {
  for (int i = 0; i < q.size(); ++i) {
    if (!(std::fabs(q_reference[i] - q[i]) <= config.following_error)) {
      return i;
    }
  }
  return -1;
}

}  // namespace fovea::guard
