// SPDX-License-Identifier: Apache-2.0
#include "sim/faults/faulty_arm.hpp"

#include <limits>

#include "sim/faults/chance.hpp"

namespace fovea::sim {

FaultyArm::FaultyArm(hal::Arm& arm, const ArmFaults& faults)
    : Arm(arm.num_joints(), arm.paces_loop()), arm_(arm), faults_(faults), random_(faults.seed) {}

void FaultyArm::SetFaults(const ArmFaults& faults) {
  const std::uint64_t seed = faults_.seed;
  faults_ = faults;
  faults_.seed = seed;
}

hal::Status FaultyArm::DoRead(hal::ArmState& state) noexcept {
  hal::ArmState read;
  if (const hal::Status status = arm_.Read(read); !status.ok()) {
    return status;
  }
  const bool lost = faults_.packet_loss.window.Contains(read.stamp_ns) &&
                    Chance(faults_.seed, read.sequence) < faults_.packet_loss.share;
  Spoil(read);  // also for a lost state, so that later states do not depend on the loss
  if (lost) {
    return hal::Status(hal::StatusCode::kTimeout, "sim arm");
  }
  state = read;
  return hal::Status::Ok();
}

void FaultyArm::Spoil(hal::ArmState& state) noexcept {
  const std::int64_t now_ns = state.stamp_ns;
  if (faults_.stuck.window.Contains(now_ns)) {
    stuck_at_ = is_stuck_ ? stuck_at_ : state.q;
    is_stuck_ = true;
    for (int joint = 0; joint < state.num_joints; ++joint) {
      if (faults_.stuck.joint == joint || faults_.stuck.joint == kAllJoints) {
        const auto k = static_cast<std::size_t>(joint);
        state.q[k] = stuck_at_[k];
        state.dq[k] = 0.0;
      }
    }
  } else {
    is_stuck_ = false;
  }
  if (faults_.noise.window.Contains(now_ns)) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(state.num_joints); ++k) {
      state.q[k] += faults_.noise.position * normal_(random_);
      state.dq[k] += faults_.noise.velocity * normal_(random_);
    }
  }
  if (faults_.not_a_number.window.Contains(now_ns)) {
    state.q[static_cast<std::size_t>(faults_.not_a_number.joint)] = std::numeric_limits<double>::quiet_NaN();
  }
  if (faults_.clock_jump.window.Contains(now_ns)) {
    state.stamp_ns += faults_.clock_jump.by_ns;
  }
}

}  // namespace fovea::sim
