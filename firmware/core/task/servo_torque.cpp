// SPDX-License-Identifier: Apache-2.0
// The stages that decide what the motors do: the motion law, the damped stop and the clamp.
#include <cmath>

#include "firmware/core/guard/clamp_torque.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"
#include "firmware/core/task/servo_task.hpp"

namespace fovea::task {
void ServoTask::ComputeTorque(const ServoInputs& inputs) noexcept {
  const motion_laws::MotionLawInputs law_inputs{config_.arm,      state_.poses, state_.dynamics,
                                                state_.reference, state_.q,     state_.dq};
  if (inputs.change_law && may_drive_[static_cast<std::size_t>(inputs.law)]) {
    motion_laws::ChangeMotionLaw(config_.motion_law, law_inputs, inputs.law, state_.law_state);
  }
  switch (state_.mode.mode) {
    case hal::Mode::kBoot:
      if (!state_.holds) {
        state_.tau.setZero(config_.arm.num_joints);
        state_.law_state.Reset(state_.law_state.kind, config_.arm.num_joints);
        break;
      }
      [[fallthrough]];
    case hal::Mode::kHold:
    case hal::Mode::kTrack:
    case hal::Mode::kCoast:
    case hal::Mode::kMove:
      if (state_.inputs.bad_ticks == 0) {
        motion_laws::MotionLaw(config_.motion_law, law_inputs, state_.law_state, state_.tau);
        estimate::CarryLoad(
            {config_.arm, config_.safety.stiction_fraction, config_.safety.carried_torque_fraction, Stands()},
            state_.contact, state_.tau);
        HoldLoadOffset();
      }
      break;
    case hal::Mode::kFault: StopDamped(); break;
  }
}

// Adds the weight of the part of the load that the robot does not know.
void ServoTask::HoldLoadOffset() noexcept {
  if (config_.load.offset != 0.0) {
    state_.tau += model::HoldingTorque(config_.arm, state_.poses, config::OffsetOf(config_.load));
  }
}

// True if unknown loads are compensated: enabled, with a law that holds the arm in place, and without an
// integral, which would learn the load by itself.
bool ServoTask::CarriesLoads() const noexcept {
  return config_.safety.carried_torque_fraction > 0.0 && config_.motion_law.integral == 0.0 &&
         motion_laws::EntryOf(state_.law_state.kind).carries;
}

// True if the arm should stand still with its load compensated.
bool ServoTask::Stands() const noexcept {
  const bool may_stand = state_.mode.mode == hal::Mode::kBoot || state_.mode.mode == hal::Mode::kHold;
  return may_stand && CarriesLoads() && state_.reference.dq.isZero(0.0);
}

void ServoTask::StopDamped() noexcept {
  const bool blind = state_.inputs.bad_ticks > 0 || state_.inputs.non_finite_ticks > 0 ||
                     state_.inputs.jumped || state_.blind || state_.mode.fault == hal::Fault::kArmStale;
  const double since_s =
      static_cast<double>(state_.now_ns - state_.mode_since_ns) / static_cast<double>(hal::kNsPerSecond);
  guard::StopAfterFault(config_.safety, state_.dynamics, state_.dq, blind, since_s, state_.stop, state_.tau);
  if (!blind && state_.stop.stage == guard::FaultStop::Stage::kDamped) {
    HoldLoadOffset();
  }
}

void ServoTask::Clamp() noexcept {
  // The rate limit starts at the torque that the arm reports as in force. If the report is missing or
  // impossible, it starts at the last command; so it does behind closed brakes, where the arm holds itself.
  model::VecN in_force = state_.tau_applied;
  const bool told = state_.inputs.bad_ticks == 0 && state_.inputs.non_finite_ticks == 0;
  const bool behind_brakes = state_.stop.stage == guard::FaultStop::Stage::kBraked;
  for (int i = 0; i < in_force.size(); ++i) {
    const double tau_max = config_.arm.joints[static_cast<std::size_t>(i)].tau_max;
    if (!told || behind_brakes || std::fabs(in_force[i]) > tau_max) {
      in_force[i] = state_.tau_before[i];
    }
  }
  state_.law_state.cut = state_.tau;
  const guard::ClampResult result = guard::ClampTorque(config_.arm, config_.safety, in_force, state_.tau);
  state_.law_state.cut -= state_.tau;
  state_.limits |= result.limits;
  guard::CloseBrakes(state_.tau, state_.stop);
  if (!result.finite) {
    LatchFault(hal::Fault::kNonFiniteControl, -1);
  }
}

}  // namespace fovea::task
