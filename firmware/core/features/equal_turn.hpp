// SPDX-License-Identifier: Apache-2.0
// The turns of a flat target about its own axis after which it looks the same: a square's four.
#pragma once

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::features {

// The `turn`-th of `turns` equal turns about z; exact for quarter turns. Real-time: yes.
[[nodiscard]] model::Mat3 EqualTurn(int turn, int turns) noexcept;

// The equal turn of the target, seen as `R_CO`, that comes nearest to the goal's orientation; 0 if it has
// only one. Real-time: yes.
[[nodiscard]] int NearestTurn(const TargetFeature& feature, const model::Mat3& R_CO) noexcept;

}  // namespace fovea::features
