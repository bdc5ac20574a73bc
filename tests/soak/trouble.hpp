// What a soak lets happen to arm, eye and computer: a list, and when each of them lasts.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/events.hpp"

namespace fovea::soak {

enum class Trouble : std::uint8_t {
  kNone,
  kSilence,       // the arm does not answer for some ticks
  kLongSilence,   // for longer than it may
  kNoNumber,      // an encoder's value is no number, for some ticks
  kNoNumberLong,  // for longer than it may
  kStall,         // the computer swallows some ticks
  kLongStall,     // more than it may
  kPush,          // somebody leans on a joint
  kShove,         // harder than is borne
  kBlink,         // no measurement for a moment
  kBlind,         // for longer than prediction reaches
  kWrongFeature,  // the detector sees the target elsewhere
  kNoFeature,     // it says what is no number
  kLateFeature,   // its measurements come 60 ms later
  kHoldAsked,     // the operator asks to hold, and then to track again
};
inline constexpr std::array<const char*, 15> kTroubleNames{
    "none",  "silence",       "long_silence", "no_number",    "no_number_long",
    "stall", "long_stall",    "push",         "shove",        "blink",
    "blind", "wrong_feature", "no_feature",   "late_feature", "hold_asked"};

// Whether it may lead to `fault`; kNone: it may be borne. A shove may make a joint too fast, or take it away
// from its reference, before it shows as a contact.
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

// How long it lasts [ms].
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
