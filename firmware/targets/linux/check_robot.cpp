// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/check_robot.hpp"

#include <fmt/format.h>

#include <cmath>

namespace fovea::hw {
namespace {

constexpr double kGravityWarn = 0.5;  // share of check.gravity_torque

}  // namespace

CheckRow CheckGravity(const robots::Robot& robot, const RestMean& mean, bool rests, double allowed_nm) {
  if (!rests) {
    return {"gravity", Verdict::kFail, "the arm moves; gravity is compared only at rest",
            "let the arm come to rest"};
  }
  const GravityFinding finding = CompareGravity(robot.model, mean.q(), mean.tau_meas());
  const double worst = std::fabs(finding.worst_nm);
  const Verdict verdict = worst <= kGravityWarn * allowed_nm ? Verdict::kPass
                          : worst <= allowed_nm              ? Verdict::kWarn
                                                             : Verdict::kFail;
  return {"gravity", verdict, InWords(finding),
          verdict == Verdict::kPass
              ? ""
              : "check that arm.load_* is the load at the flange, and that the robot knows it"};
}

CheckRow CheckRange(const robots::Robot& robot, const hal::ArmState& state, double margin) {
  for (int i = 0; i < robot.model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = robot.model.joints[k];
    if (state.q[k] < joint.q_min + margin || state.q[k] > joint.q_max - margin) {
      return {"joint ranges", Verdict::kFail, fmt::format("joint {} is at {:.3f} rad", i + 1, state.q[k]),
              fmt::format("move it by hand to between {:.3f} and {:.3f} rad", joint.q_min + margin,
                          joint.q_max - margin)};
    }
  }
  return {"joint ranges", Verdict::kPass, "all joints are inside their ranges", ""};
}

}  // namespace fovea::hw
