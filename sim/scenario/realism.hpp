// SPDX-License-Identifier: Apache-2.0
// arm.realism: figures of real arms for drives, sensors and rotors. sim/README.md names their sources.
#pragma once

#include <set>
#include <string>

#include "sim/scenario/scenario.hpp"

namespace fovea::sim {

// Sets the keys of the preset that `scenario.arm.realism` names, except those in `given`, the names of keys.
// "ideal" sets none.
void ApplyRealism(const std::set<std::string>& given, Scenario& scenario);

// InputError: the preset is of another arm.
void CheckRealism(const Scenario& scenario, const robots::Robot& robot);

}  // namespace fovea::sim
