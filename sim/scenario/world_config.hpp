// SPDX-License-Identifier: Apache-2.0
// The simulated world of a run, as it truly is.
#pragma once

#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// Sets what the keys of [arm] say of the arm `config.robot`.
void SetArm(const Scenario& scenario, WorldConfig& config);

WorldConfig MakeWorldConfig(const RunDescription& run);

}  // namespace fovea::sim
