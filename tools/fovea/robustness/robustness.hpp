// SPDX-License-Identifier: Apache-2.0
// fovea atlas --truth-size, --tornado, --margin and --robustness: what wrong beliefs cost, and how wrong they
// may be.
#pragma once

#include "tools/fovea/atlas/atlas.hpp"

namespace fovea {

// Simulates the runs, writes their files, prints the results. Returns the program's exit code. Throws
// config::InputError.
int RobustnessAtlas(const AtlasArguments& arguments);

}  // namespace fovea
