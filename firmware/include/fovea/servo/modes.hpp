// Modes and how one leads to another. The table is in modes.cpp, on one screen.
#pragma once

#include <cstdint>

#include "fovea/hal/events.hpp"
#include "fovea/servo/servo_config.hpp"

namespace fovea::servo {

// What the person, or the program above, asks of the servo; taken in at a tick.
enum class Request : std::uint8_t {
  kNone,
  kTrack,  // steer by the target as soon as it is known
  kHold,   // stand still
  kReset,  // leave Fault for Boot
};

// What the mode depends on, as seen in this tick.
struct ModeInputs {
  Request request = Request::kNone;
  bool arm_ready = false;  // enough sound states in a row, arm at rest
  bool target_known = false;
  std::int64_t feature_age_ns = 0;       // of the last accepted measurement
  bool goal_unreachable = false;         // limits kept the arm from the goal for too long
  bool target_moved = false;             // far enough from where it was unreachable to try again
  hal::Fault fault = hal::Fault::kNone;  // found in this tick
};

struct ModeState {
  hal::Mode mode = hal::Mode::kBoot;
  hal::HoldReason hold_reason = hal::HoldReason::kNone;
  hal::Fault fault = hal::Fault::kNone;  // latched
  bool track_asked = false;
};

// One tick of the mode. True when the mode changed. Real-time: yes.
bool UpdateMode(const PredictConfig& config, const ModeInputs& inputs, ModeState& state) noexcept;

}  // namespace fovea::servo
