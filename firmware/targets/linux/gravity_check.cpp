// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/gravity_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/load.hpp"

namespace fovea::hw {
namespace {

model::VecN GravityOf(const model::ArmModel& arm, const model::VecN& q) {
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::ComputePoses(arm, q, poses);
  model::ComputeDynamics(arm, poses, model::VecN::Zero(arm.num_joints), dynamics);
  return dynamics.g;
}

}  // namespace

GravityFinding CompareGravity(const model::ArmModel& arm, const hal::JointArray& q,
                              const hal::JointArray& tau_meas) {
  const model::VecN q_now = model::ToVector(q, arm.num_joints);
  const model::VecN g = GravityOf(arm, q_now);
  const model::VecN off = model::ToVector(tau_meas, arm.num_joints) - g;
  model::ArmModel loaded = arm;
  model::Attach({.mass = 1.0}, loaded);
  const model::VecN per_kg = GravityOf(loaded, q_now) - g;
  GravityFinding finding;
  finding.unknown_mass_kg = per_kg.dot(off) / per_kg.squaredNorm();
  for (int i = 0; i < arm.num_joints; ++i) {
    if (!(std::fabs(off[i]) <= std::fabs(finding.worst_nm))) {
      finding.worst_nm = off[i];
      finding.joint = i;
    }
    if (!std::isfinite(finding.worst_nm)) {
      break;
    }
  }
  return finding;
}

std::string InWords(const GravityFinding& finding) {
  const std::string off = fmt::format("measured torques differ from the model by {:.2f} Nm at joint {}",
                                      std::fabs(finding.worst_nm), finding.joint + 1);
  const bool lighter = finding.unknown_mass_kg < 0.0;
  return fmt::format("{}, as with {:.2f} kg {} at the end effector", off, std::fabs(finding.unknown_mass_kg),
                     lighter ? "too little" : "too much");
}

bool RestMean::Add(const hal::ArmState& state) noexcept {
  ++seen_;
  const bool rests = std::all_of(state.dq.begin(), state.dq.end(),
                                 [this](double speed) { return std::fabs(speed) < rest_speed_; });
  if (!rests) {
    count_ = 0;
    q_ = {};
    tau_ = {};
    return false;
  }
  for (std::size_t k = 0; k < q_.size(); ++k) {
    q_[k] += state.q[k];
    tau_[k] += state.tau_meas[k];
  }
  return ++count_ >= states_;
}

hal::JointArray RestMean::Divided(hal::JointArray sum) const noexcept {
  for (double& value : sum) {
    value /= std::max(count_, 1);
  }
  return sum;
}

}  // namespace fovea::hw
