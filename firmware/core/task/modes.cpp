// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/task/modes.hpp"

#include <array>

namespace fovea::task {
namespace {

using hal::HoldReason;
using hal::Mode;
using F = ModeFacts;

constexpr ModeEdge FromAny(const char* words, bool (*when)(const F&), Mode to) {
  return {true, Mode::kBoot, words, when, to, HoldReason::kNone};
}
constexpr ModeEdge From(Mode from, const char* words, bool (*when)(const F&), Mode to,
                        HoldReason reason = HoldReason::kNone) {
  return {false, from, words, when, to, reason};
}

// The reason for the last motion's end stays reported until the next request.
constexpr bool IsSaidOn(HoldReason reason) {
  return reason == HoldReason::kMotionDone || reason == HoldReason::kMotionRefused ||
         reason == HoldReason::kNotFollowed || reason == HoldReason::kEyeDoubted;
}

// The first transition that fits is taken.
// clang-format off
constexpr std::array kEdges{
    FromAny(            "a fault is found",                   [](const F& f) { return f.fault; },            Mode::kFault),
    From(Mode::kFault,  "reset is requested",                 [](const F& f) { return f.request == Request::kReset; }, Mode::kBoot),
    From(Mode::kBoot,   "the arm is sound and at rest, track is requested", [](const F& f) { return f.ready && f.asked; }, Mode::kHold, HoldReason::kNoTarget),
    From(Mode::kBoot,   "the arm is sound and at rest",       [](const F& f) { return f.ready; },            Mode::kHold, HoldReason::kNotAsked),

    From(Mode::kHold,   "goal unreachable, no reason to try again", [](const F& f) { return f.asked && f.hold_reason == HoldReason::kGoalUnreachable && !f.again; }, Mode::kHold, HoldReason::kGoalUnreachable),
    From(Mode::kHold,   "track is requested, the target seen", [](const F& f) { return f.asked && f.fresh; }, Mode::kTrack),
    From(Mode::kHold,   "a motion is commanded",              [](const F& f) { return !f.asked && f.motion; }, Mode::kMove),
    From(Mode::kHold,   "track is requested, after a motion or none", [](const F& f) { return f.asked && f.hold_reason != HoldReason::kTargetLost; }, Mode::kHold, HoldReason::kNoTarget),
    From(Mode::kHold,   "nothing is requested",               [](const F& f) { return !f.asked && !IsSaidOn(f.hold_reason); }, Mode::kHold, HoldReason::kNotAsked),
    From(Mode::kHold,   "hold is requested",                  [](const F& f) { return f.request == Request::kHold; }, Mode::kHold, HoldReason::kNotAsked),

    From(Mode::kTrack,  "track is no longer requested",       [](const F& f) { return !f.asked; },           Mode::kHold, HoldReason::kNotAsked),
    From(Mode::kTrack,  "the eye cannot steer the arm",       [](const F& f) { return f.doubted; },          Mode::kHold, HoldReason::kEyeDoubted),
    From(Mode::kTrack,  "limits keep the arm from the goal",  [](const F& f) { return f.unreachable; },      Mode::kHold, HoldReason::kGoalUnreachable),
    From(Mode::kTrack,  "the target is lost",                 [](const F& f) { return f.lost; },             Mode::kHold, HoldReason::kTargetLost),
    From(Mode::kTrack,  "the target is not seen for a moment", [](const F& f) { return !f.fresh; },          Mode::kCoast),
    From(Mode::kCoast,  "track is no longer requested",       [](const F& f) { return !f.asked; },           Mode::kHold, HoldReason::kNotAsked),
    From(Mode::kCoast,  "the eye cannot steer the arm",       [](const F& f) { return f.doubted; },          Mode::kHold, HoldReason::kEyeDoubted),
    From(Mode::kCoast,  "limits keep the arm from the goal",  [](const F& f) { return f.unreachable; },      Mode::kHold, HoldReason::kGoalUnreachable),
    From(Mode::kCoast,  "the target is lost",                 [](const F& f) { return f.lost; },             Mode::kHold, HoldReason::kTargetLost),
    From(Mode::kCoast,  "the target is seen again",           [](const F& f) { return f.fresh; },            Mode::kTrack),

    From(Mode::kMove,   "hold is requested",                  [](const F& f) { return f.request == Request::kHold; }, Mode::kHold, HoldReason::kNotAsked),
    From(Mode::kMove,   "track is requested",                 [](const F& f) { return f.asked; },            Mode::kHold, HoldReason::kNoTarget),
    From(Mode::kMove,   "a limit forbids the motion",         [](const F& f) { return f.refused; },          Mode::kHold, HoldReason::kMotionRefused),
    From(Mode::kMove,   "the arm does not follow the motion", [](const F& f) { return f.astray; },         Mode::kHold, HoldReason::kNotFollowed),
    From(Mode::kMove,   "the motion is done",                 [](const F& f) { return !f.motion; },          Mode::kHold, HoldReason::kMotionDone),
};
// clang-format on

std::int64_t Ns(double seconds) noexcept {
  return static_cast<std::int64_t>(seconds * static_cast<double>(hal::kNsPerSecond));
}

}  // namespace

std::span<const ModeEdge> ModeEdges() noexcept { return kEdges; }

ModeFacts FactsOf(const config::PredictConfig& config, const ModeInputs& inputs,
                  const ModeState& state) noexcept {
  ModeFacts f{};
  f.request = inputs.request;
  f.hold_reason = state.hold_reason;
  f.fault = inputs.fault != hal::Fault::kNone;
  f.ready = inputs.arm_ready;
  f.asked = inputs.request == Request::kTrack || (state.track_asked && inputs.request != Request::kHold);
  f.fresh = inputs.target_known && inputs.feature_age_ns <= Ns(config.stale_s);
  f.lost = !inputs.target_known || inputs.feature_age_ns > Ns(config.coast_s);
  f.unreachable = inputs.goal_unreachable;
  f.again = inputs.may_try_again;
  f.doubted = inputs.eye_doubted || (f.lost && inputs.eye_suspected);
  f.motion = inputs.motion_asked && !state.motion_barred;
  f.refused = inputs.motion_refused;
  f.astray = inputs.motion_not_followed;
  return f;
}

bool UpdateMode(const config::PredictConfig& config, const ModeInputs& inputs, ModeState& state) noexcept {
  const Mode before = state.mode;
  const ModeFacts facts = FactsOf(config, inputs, state);
  state.track_asked = facts.asked;
  for (const ModeEdge& edge : kEdges) {
    if ((edge.from_any || edge.from == before) && edge.when(facts)) {
      state.mode = edge.to;
      state.hold_reason = edge.reason;
      break;
    }
  }
  if (state.mode == Mode::kFault && before != Mode::kFault) {
    state.fault = inputs.fault;  // the first cause stays
  } else if (state.mode != Mode::kFault) {
    state.fault = hal::Fault::kNone;
  }
  if (before == Mode::kFault || state.mode == Mode::kFault ||
      (before != Mode::kHold && state.hold_reason == HoldReason::kEyeDoubted)) {
    state.track_asked = false;  // a fault cancels every request: nothing moves until it is requested again
  }
  if (!inputs.motion_asked) {
    state.motion_barred = false;
  }
  // A motion that was interrupted, or commanded while something else moves the arm, does not start later.
  const bool broken_off = before == Mode::kMove && state.mode != Mode::kMove;
  const bool elsewhere =
      state.mode == Mode::kTrack || state.mode == Mode::kCoast || state.mode == Mode::kFault;
  if (inputs.motion_asked && (broken_off || elsewhere || inputs.request == Request::kHold)) {
    state.motion_barred = true;
  }
  return state.mode != before;
}

}  // namespace fovea::task
