// SPDX-License-Identifier: Apache-2.0
// Random joint states, the same in every run.
#pragma once

#include <random>

#include "firmware/core/model/arm_model.hpp"

namespace fovea::test {

class RandomStates {
 public:
  explicit RandomStates(unsigned seed) : engine_(seed) {}

  double Uniform(double min, double max) { return std::uniform_real_distribution<double>(min, max)(engine_); }

  model::Vec3 Vector(double size) {
    return {Uniform(-size, size), Uniform(-size, size), Uniform(-size, size)};
  }

  // Uniform in the joints' range, within +-3.2 [rad or m].
  model::VecN Position(const model::ArmModel& arm) {
    model::VecN q(arm.num_joints);
    for (int i = 0; i < arm.num_joints; ++i) {
      const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
      q[i] = Uniform(std::max(joint.q_min, -3.2), std::min(joint.q_max, 3.2));
    }
    return q;
  }

  // Each entry in -size to size.
  model::VecN Joints(const model::ArmModel& arm, double size) {
    model::VecN v(arm.num_joints);
    for (int i = 0; i < arm.num_joints; ++i) {
      v[i] = Uniform(-size, size);
    }
    return v;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace fovea::test
