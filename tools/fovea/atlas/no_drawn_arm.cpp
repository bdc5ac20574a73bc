// SPDX-License-Identifier: Apache-2.0
// In place of drawn_arm.cpp in a build without the simulator.
#include "firmware/host/config/input_error.hpp"
#include "tools/fovea/atlas/drawn_arm.hpp"

namespace fovea::atlas {

struct DrawnArm::Parts {};

DrawnArm::DrawnArm(const robots::Robot& /*robot*/) {
  throw config::InputError("fovea atlas: this program was built without the simulator");
}

bool DrawnArm::Hides(const model::VecN& /*q*/, const model::Vec3& /*p_BC*/,
                     const std::vector<model::Vec3>& /*points_B*/) const {
  return false;
}

}  // namespace fovea::atlas
