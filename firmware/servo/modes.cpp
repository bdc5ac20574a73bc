#include "fovea/servo/modes.hpp"

namespace fovea::servo {
namespace {

using hal::HoldReason;
using hal::Mode;

std::int64_t Ns(double seconds) noexcept {
  return static_cast<std::int64_t>(seconds * static_cast<double>(hal::kNsPerSecond));
}

void EnterHold(HoldReason reason, ModeState& state) noexcept {
  state.mode = Mode::kHold;
  state.hold_reason = reason;
}

void EnterTrack(Mode mode, ModeState& state) noexcept {
  state.mode = mode;
  state.hold_reason = HoldReason::kNone;
}

}  // namespace

bool UpdateMode(const PredictConfig& config, const ModeInputs& inputs, ModeState& state) noexcept {
  const Mode before = state.mode;
  const bool fresh = inputs.target_known && inputs.feature_age_ns <= Ns(config.stale_s);
  const bool lost = !inputs.target_known || inputs.feature_age_ns > Ns(config.coast_s);
  if (inputs.request == Request::kTrack) {
    state.track_asked = true;
  } else if (inputs.request == Request::kHold) {
    state.track_asked = false;
  }

  if (inputs.fault != hal::Fault::kNone) {
    if (state.mode != Mode::kFault) {
      state.fault = inputs.fault;  // the first cause stays
    }
    state.mode = Mode::kFault;
    state.hold_reason = HoldReason::kNone;
    return state.mode != before;
  }

  // from    when                              to
  switch (state.mode) {
    case Mode::kFault:
      if (inputs.request == Request::kReset) {
        state.mode = Mode::kBoot;
        state.fault = hal::Fault::kNone;
      }
      break;
    case Mode::kBoot:
      if (inputs.arm_ready) {
        EnterHold(state.track_asked ? HoldReason::kNoTarget : HoldReason::kNotAsked, state);
      }
      break;
    case Mode::kHold:
      if (!state.track_asked) {
        state.hold_reason = HoldReason::kNotAsked;
      } else if (state.hold_reason == HoldReason::kGoalUnreachable && !inputs.target_moved) {
        break;
      } else if (fresh) {
        EnterTrack(Mode::kTrack, state);
      } else if (state.hold_reason == HoldReason::kNotAsked) {
        state.hold_reason = HoldReason::kNoTarget;
      }
      break;
    case Mode::kTrack:
    case Mode::kCoast:
      if (!state.track_asked) {
        EnterHold(HoldReason::kNotAsked, state);
      } else if (inputs.goal_unreachable) {
        EnterHold(HoldReason::kGoalUnreachable, state);
      } else if (lost) {
        EnterHold(HoldReason::kTargetLost, state);
      } else {
        EnterTrack(fresh ? Mode::kTrack : Mode::kCoast, state);
      }
      break;
  }
  return state.mode != before;
}

}  // namespace fovea::servo
