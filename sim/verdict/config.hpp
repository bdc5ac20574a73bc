// SPDX-License-Identifier: Apache-2.0
// Builds the verdict's configuration from a run's description.
#pragma once

#include "sim/scenario/run_description.hpp"
#include "sim/verdict/verdict.hpp"

namespace fovea::sim {

VerdictConfig MakeVerdictConfig(const RunDescription& about);

}  // namespace fovea::sim
