// SPDX-License-Identifier: Apache-2.0
// Detects an arm that does not follow its reference.
#pragma once

#include "firmware/core/config/safety_config.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::guard {

// The first joint whose `q` differs from `q_reference` (both [num_joints] [rad, m]) by more than
// safety.following_error, or by no number; -1 if there is none. Real-time: yes.
[[nodiscard]] int JointThatDoesNotFollow(const config::SafetyConfig& config, const model::VecN& q_reference,
                                         const model::VecN& q) noexcept;

}  // namespace fovea::guard
