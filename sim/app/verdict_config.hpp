// What a run is judged by.
#pragma once

#include "sim/app/run_description.hpp"
#include "sim/app/verdict.hpp"

namespace fovea::sim {

VerdictConfig MakeVerdictConfig(const RunDescription& about);

}  // namespace fovea::sim
