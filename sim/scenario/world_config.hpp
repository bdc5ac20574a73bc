// SPDX-License-Identifier: Apache-2.0
// The simulated world of a run, as it truly is.
#pragma once

#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

WorldConfig MakeWorldConfig(const RunDescription& run);

}  // namespace fovea::sim
