// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/task/check_inputs.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::task {
namespace {

constexpr double kJump = 0.02;          // allowed change of a position beyond the speed limit's [rad, m]
constexpr double kVelocityJump = 0.02;  // and of a velocity beyond the torque's [rad/s, m/s]
constexpr double kTorqueAtMost = 2.0;   // times the acceleration limit: external torques add to it
constexpr int kBadTicksMost = 1'000'000'000;  // the counter stops here

// If a measured velocity differs from the last one by more than any torque can cause in `elapsed_s`, only the
// change that the motors can make in a tick counts. This happens when an encoder begins to hang, or gives
// only noise. Returns the first such joint, or -1.
std::int32_t BridgeVelocityJumps(const model::ArmModel& arm, double elapsed_s,
                                 const hal::JointArray& dq_before, hal::JointArray& dq) noexcept {
  std::int32_t jumps = -1;
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double ddq = arm.joints[k].ddq_max;
    const double change = dq[k] - dq_before[k];
    if (std::fabs(change) > kVelocityJump + kTorqueAtMost * ddq * elapsed_s) {
      dq[k] = dq_before[k] + std::copysign(ddq * hal::kTickPeriodS, change);
      jumps = jumps < 0 ? i : jumps;
    }
  }
  return jumps;
}

// Copies the finite values of `from`; a joint that is not finite keeps its last value. Returns the first
// such joint, or -1.
std::int32_t CopyFinite(const hal::JointArray& from, int num_joints, hal::JointArray& to) noexcept {
  std::int32_t bad = -1;
  for (int i = 0; i < num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (std::isfinite(from[k])) {
      to[k] = from[k];
    } else if (bad < 0) {
      bad = i;
    }
  }
  return bad;
}

// Checks the arm's answer alone.
InputCheck TakeIn(const config::ServoConfig& config, const hal::Status& arm_status, const hal::ArmState& arm,
                  std::int32_t missed_ticks, double velocity_share, InputState& state) noexcept {
  const config::SafetyConfig& safety = config.safety;
  const int n = config.arm.num_joints;
  const bool answered = arm_status.ok() && arm.num_joints == n;
  const bool fresh = answered && (!state.has_state || arm.stamp_ns > state.stamp_ns);
  if (!fresh) {
    state.sound_ticks = 0;
    // Missed ticks count as silence too.
    const int passed = static_cast<int>(std::clamp<std::int32_t>(missed_ticks, 0, kBadTicksMost));
    state.bad_ticks = std::min(state.bad_ticks + 1 + passed, kBadTicksMost);
    if (state.bad_ticks >= safety.arm_lost_ticks) {
      return {answered ? hal::Fault::kArmStale : hal::Fault::kArmLost, -1};
    }
    return {};
  }
  const double elapsed_s =
      state.has_state ? 1e-9 * static_cast<double>(arm.stamp_ns - state.stamp_ns) : HUGE_VAL;
  const bool is_first = !state.has_state;
  const hal::JointArray q_before = state.q;
  const hal::JointArray dq_before = state.dq;
  // Ticks without a state and ticks that the computer missed count as one silence if one follows the other.
  const bool was_lost =
      state.bad_ticks > 0 && std::int64_t{state.bad_ticks} + missed_ticks >= safety.arm_lost_ticks;
  state.has_state = true;
  state.stamp_ns = arm.stamp_ns;
  state.sequence = arm.sequence;
  state.bad_ticks = 0;

  std::int32_t bad = CopyFinite(arm.q, n, state.q);
  if (const std::int32_t bad_dq = CopyFinite(arm.dq, n, state.dq); bad < 0) {
    bad = bad_dq;
  }
  if (const std::int32_t bad_tau = CopyFinite(arm.tau_applied, n, state.tau_applied); bad < 0) {
    bad = bad_tau;
  }
  if (bad >= 0) {
    state.sound_ticks = 0;
    state.non_finite_ticks += 1;
    if (state.non_finite_ticks > safety.non_finite_ticks) {
      return {hal::Fault::kNonFiniteSensor, bad};
    }
    return {};
  }
  state.non_finite_ticks = 0;
  if (was_lost) {
    state.sound_ticks = 0;
    return {hal::Fault::kArmLost, -1};
  }
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config.arm.joints[k];
    if (state.q[k] < joint.q_min || state.q[k] > joint.q_max) {
      return {hal::Fault::kJointPosition, i};
    }
    const bool leaps = std::fabs(state.q[k] - q_before[k]) > joint.dq_max * elapsed_s + kJump;
    if (leaps || std::fabs(state.dq[k]) > velocity_share * joint.dq_max) {
      return {hal::Fault::kJointVelocity, i};
    }
  }
  const hal::JointArray dq = state.dq;
  // A rejected change may have been partly true.
  const double since_s = elapsed_s * (1.0 + 0.25 * state.jumps);
  const std::int32_t joint = is_first ? -1 : BridgeVelocityJumps(config.arm, since_s, dq_before, state.dq);
  state.jumped = joint >= 0;
  state.jumps = std::max(state.jumps + (state.jumped ? 2 : -1), 0);
  if (state.jumped) {
    state.sound_ticks = 0;
    if (state.jumps > 2 * safety.non_finite_ticks) {
      const auto k = static_cast<std::size_t>(joint);
      const bool stays = std::fabs(state.q[k] - q_before[k]) < 0.5 * std::fabs(dq_before[k]) * elapsed_s;
      state.jumps = 0;
      state.jumped = false;
      state.dq = dq;  // from now on this velocity counts
      return {stays ? hal::Fault::kArmStale : hal::Fault::kJointVelocity, joint};
    }
    return {};
  }
  state.sound_ticks += 1;
  return {};
}

}  // namespace

InputCheck CheckInputs(const config::ServoConfig& config, const hal::Status& arm_status,
                       const hal::ArmState& arm, std::int32_t missed_ticks, double velocity_share,
                       InputState& state) noexcept {
  const InputCheck check = TakeIn(config, arm_status, arm, missed_ticks, velocity_share, state);
  // If the arm is silent, the lateness is the arm's. A late loop shows in the arm's next state.
  if (state.bad_ticks == 0 && missed_ticks >= config.safety.missed_ticks) {
    return {hal::Fault::kDeadlineMissed, -1};
  }
  return check;
}

}  // namespace fovea::task
