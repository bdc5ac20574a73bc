// SPDX-License-Identifier: Apache-2.0
// The modes and their transitions. The table of transitions is in modes.cpp, on one screen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/core/config/servo_config.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::task {

// A request of the person or the program above to the servo; takes effect in a tick.
enum class Request : std::uint8_t {
  kNone,
  kTrack,  // steer by the target as soon as it is known
  kHold,   // stand still
  kReset,  // leave Fault for Boot
};

// The inputs of the mode in this tick.
struct ModeInputs {
  Request request = Request::kNone;
  bool arm_ready = false;  // enough sound states in a row, arm at rest
  bool target_known = false;
  std::int64_t feature_age_ns = 0;       // of the last accepted measurement
  bool goal_unreachable = false;         // limits kept the arm from the goal for too long
  bool may_try_again = false;            // the target has moved, or the planner answers again
  bool eye_doubted = false;              // the eye cannot steer the arm
  bool eye_suspected = false;            // the same, if it has lost the target
  bool motion_asked = false;             // a motion is commanded, or not yet finished
  bool motion_refused = false;           // the motion of the previous tick was refused
  bool motion_not_followed = false;      // the arm is too far off it
  hal::Fault fault = hal::Fault::kNone;  // found in this tick
};

struct ModeState {
  hal::Mode mode = hal::Mode::kBoot;
  hal::HoldReason hold_reason = hal::HoldReason::kNone;
  hal::Fault fault = hal::Fault::kNone;  // latched
  bool track_asked = false;
  bool motion_barred = false;  // the present command was stopped: only a new motion may move the arm
};

// The facts that the table's conditions use.
struct ModeFacts {
  Request request;
  hal::HoldReason hold_reason;  // before this tick
  bool fault;
  bool ready;
  bool asked;  // Track is requested
  bool fresh;  // the target was seen recently
  bool lost;   // the target was not seen for too long
  bool unreachable;
  bool again;  // another try for a goal that was unreachable
  bool doubted;
  bool motion;  // a motion may move the arm
  bool refused;
  bool astray;  // the arm is too far off the motion
};

// A transition. The first one whose `from` and `when` fit is taken. If none fits, nothing changes.
struct ModeEdge {
  bool from_any;
  hal::Mode from;
  const char* words;  // the condition, for people
  bool (*when)(const ModeFacts&);
  hal::Mode to;
  hal::HoldReason reason;  // of Hold
};
std::span<const ModeEdge> ModeEdges() noexcept;

// The facts of this tick's `inputs` in `state`.
[[nodiscard]] ModeFacts FactsOf(const config::PredictConfig& config, const ModeInputs& inputs,
                                const ModeState& state) noexcept;

// One tick of the mode. True if the mode changed. Real-time: yes.
bool UpdateMode(const config::PredictConfig& config, const ModeInputs& inputs, ModeState& state) noexcept;

}  // namespace fovea::task
