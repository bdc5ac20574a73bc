// SPDX-License-Identifier: Apache-2.0
// The disturbances of a soak on arm, camera and computer, and their durations.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/events.hpp"

namespace fovea::soak {

enum class Trouble : std::uint8_t {
  kNone,
  kSilence,       // the arm does not answer for some ticks
  kLongSilence,   // for longer than tolerated
  kNoNumber,      // an encoder reads NaN for some ticks
  kNoNumberLong,  // for longer than tolerated
  kStall,         // the computer misses some ticks
  kLongStall,     // more than tolerated
  kPush,          // a person leans on a joint
  kShove,         // harder than tolerated
  kBlink,         // no measurement for a moment
  kBlind,         // for longer than the prediction is used
  kWrongFeature,  // the detector reports a wrong position
  kNoFeature,     // the detector reports NaN
  kLateFeature,   // measurements arrive 60 ms late
  kHoldAsked,     // the operator requests Hold, then Track again
};
inline constexpr std::array<const char*, 15> kTroubleNames{
    "none",  "silence",       "long_silence", "no_number",    "no_number_long",
    "stall", "long_stall",    "push",         "shove",        "blink",
    "blind", "wrong_feature", "no_feature",   "late_feature", "hold_asked"};

// Whether the disturbance may lead to `fault`; kNone: it may be tolerated. A shove may first appear as a
// joint that is too fast or that leaves its reference, before it appears as a contact.
[[nodiscard]] constexpr bool MayLeadTo(Trouble trouble, hal::Fault fault) {
  switch (trouble) {
    case Trouble::kLongSilence: return fault == hal::Fault::kArmLost;
    case Trouble::kNoNumberLong: return fault == hal::Fault::kNonFiniteSensor;
    case Trouble::kLongStall: return fault == hal::Fault::kDeadlineMissed;
    case Trouble::kShove:
      return fault == hal::Fault::kContact || fault == hal::Fault::kJointVelocity ||
             fault == hal::Fault::kNotFollowing;
    case Trouble::kNoFeature: return fault == hal::Fault::kNonFiniteFeature;
    default: return fault == hal::Fault::kNone;
  }
}

// Duration [ms].
[[nodiscard]] constexpr int LengthOf(Trouble trouble) {
  switch (trouble) {
    case Trouble::kNone: return 0;
    case Trouble::kSilence: return 12;
    case Trouble::kLongSilence: return 60;
    case Trouble::kNoNumber: return 4;
    case Trouble::kNoNumberLong: return 25;
    case Trouble::kStall:
    case Trouble::kLongStall: return 1;
    case Trouble::kPush: return 200;
    case Trouble::kShove: return 250;
    case Trouble::kBlink: return 300;
    case Trouble::kBlind: return 1500;
    case Trouble::kWrongFeature: return 60;
    case Trouble::kNoFeature: return 40;
    case Trouble::kLateFeature: return 1000;
    case Trouble::kHoldAsked: return 400;
  }
  return 0;
}

}  // namespace fovea::soak
