// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/levers.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::barriers {

PerJoint Levers(const model::ArmModel& arm, const config::HandShape& hand) noexcept {
  PerJoint levers{};
  double reach = 0.0;  // of the parts bolted to the end effector
  for (int i = 0; i < hand.num_balls; ++i) {
    reach = std::max(reach, hand.balls[static_cast<std::size_t>(i)].p_EP.norm());
  }
  double length = arm.X_LnE.p.norm() + reach;  // of the links from here on
  for (int i = arm.num_joints - 1; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Capsule& body = arm.shape.bodies[k + 1];
    length = std::max({length, body.p_LA.norm(), body.p_LB.norm()});
    const model::Joint& joint = arm.joints[k];
    if (joint.type == model::JointType::kRevolute) {
      levers[k] = length;
    } else {
      levers[k] = 1.0;
      length += std::max(std::fabs(joint.q_min), std::fabs(joint.q_max));
    }
    length += joint.X_PJ.p.norm();
  }
  return levers;
}

}  // namespace fovea::barriers
