// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/task/enter_mode.hpp"

namespace fovea::task {
namespace {

// Track from Hold is a new try; Track from Coast continues the old one.
void BeginToTrack(ServoState& state) noexcept {
  state.track_since_ns = state.now_ns;
  state.reach.blocked_ns = 0;
  state.eye = estimate::EyeWatch{};
  state.way.Restart();
  state.R_BC_held = state.X_BC.R;
}

void BeginToHold(ServoState& state) noexcept {
  state.reach.p_BO_unreachable = state.prediction.p_BO;
  state.reach.planner_was_late = state.way.IsPlannerLate();
  if (state.mode.hold_reason == hal::HoldReason::kTargetLost ||
      state.mode.hold_reason == hal::HoldReason::kEyeDoubted) {
    state.predict.Reset();
  }
  if (state.mode.hold_reason == hal::HoldReason::kEyeDoubted) {
    state.predict.lateness = estimate::LearntLateness{};  // it was learnt from pictures that are not believed
  }
}

void BeginToBoot(const ModeChange& change, ServoState& state) noexcept {
  state.inputs.sound_ticks = 0;
  state.holds = false;
  state.contact.Reset(change.num_joints, change.carries_loads);
  state.push = estimate::PushWatch{};
  state.encoders = estimate::EncoderWatch{};
  state.fault_joint = -1;
  state.stop = guard::FaultStop{};
}

}  // namespace

void EnterMode(const ModeChange& change, ServoState& state) noexcept {
  state.mode_since_ns = state.now_ns;
  const hal::Mode now = state.mode.mode;
  if (now != hal::Mode::kMove) {
    state.motion.Stop();
    state.motion.refused = false;
    state.motion.off.setZero(change.num_joints);
  }
  ForgetMotion(state);
  if (now != hal::Mode::kTrack && now != hal::Mode::kCoast) {
    state.way.Restart();
  }
  switch (now) {
    case hal::Mode::kTrack:
      if (change.before == hal::Mode::kHold) {
        BeginToTrack(state);
      }
      break;
    case hal::Mode::kHold: BeginToHold(state); break;
    case hal::Mode::kBoot: BeginToBoot(change, state); break;
    case hal::Mode::kCoast:
    case hal::Mode::kMove:
    case hal::Mode::kFault: break;
  }
}

void ForgetMotion(ServoState& state) noexcept {
  state.resolved = control::ResolvedMotion{};
  state.motion.resolved = control::ResolvedMotion{};
}

}  // namespace fovea::task
