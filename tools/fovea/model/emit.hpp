// An arm's model as C++ source, for firmware that has no file to read it from.
#pragma once

#include <string>

#include "firmware/host/robots/robot.hpp"

namespace fovea {

// A header that defines `fovea::arms::Load<Name>(model::ArmModel&)`; its numbers are those of `robot` to the
// last bit.
std::string EmitModel(const robots::Robot& robot);

}  // namespace fovea
