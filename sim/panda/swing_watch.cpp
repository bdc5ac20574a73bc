// SPDX-License-Identifier: Apache-2.0
#include "sim/panda/swing_watch.hpp"

#include <algorithm>

namespace fovea::sim {

bool SwingWatch::Step(const Joints& dq) {
  ++now_;
  bool swings = false;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Joint& joint = joints_[i];
    const double speed = dq[static_cast<Eigen::Index>(i)];
    joint.extreme = joint.rises ? std::max(joint.extreme, speed) : std::min(joint.extreme, speed);
    const double back = joint.rises ? joint.extreme - speed : speed - joint.extreme;
    if (back < kSwing) {
      continue;
    }
    joint.rises = !joint.rises;
    joint.extreme = speed;
    joint.turns[joint.next] = now_;
    joint.next = (joint.next + 1) % kTurns;
    swings = swings || now_ - joint.turns[joint.next] <= kWindow;
  }
  return swings;
}

}  // namespace fovea::sim
