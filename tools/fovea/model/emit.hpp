// SPDX-License-Identifier: Apache-2.0
// An arm's model as C++ source, for firmware without a file system.
#pragma once

#include <string>

#include "firmware/host/robots/robot.hpp"

namespace fovea {

// A header that defines `fovea::arms::Load<Name>(model::ArmModel&)`. Its numbers equal those of `robot` to
// the last bit.
std::string EmitModel(const robots::Robot& robot);

}  // namespace fovea
