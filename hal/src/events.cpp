// SPDX-License-Identifier: Apache-2.0
// One table per enumeration, with name and key side by side.
#include "fovea/hal/events.hpp"

#include <array>

namespace fovea::hal {
namespace {

struct Entry {
  const char* name;
  const char* key;
};

constexpr std::array<Entry, kNumFaults> kFaultTable{{
    {"none", ""},
    {"arm_lost", "safety.arm_lost_ticks"},
    {"arm_stale", "safety.arm_lost_ticks"},
    {"non_finite_sensor", "safety.non_finite_ticks"},
    {"non_finite_feature", ""},
    {"non_finite_control", ""},
    {"deadline_missed", "safety.missed_ticks"},
    {"joint_position", "arm.model"},
    {"joint_velocity", "arm.model"},
    {"not_following", "safety.following_error"},
    {"contact", "safety.contact_torque_fraction"},
}};

constexpr std::array<Entry, kNumLimits> kLimitTable{{
    {"joint_position", "safety.joint_position_margin"},
    {"joint_velocity", "safety.joint_velocity_fraction"},
    {"joint_acceleration", "safety.joint_acceleration_fraction"},
    {"joint_jerk", "safety.joint_jerk_fraction"},
    {"workspace", "safety.workspace_radius"},
    {"torque", "safety.torque_fraction"},
    {"torque_rate", "safety.torque_rate_fraction"},
    {"obstacle", "safety.planes"},
    {"cartesian_speed", "safety.cartesian_speed"},
    {"singularity", "safety.singularity_min"},
    {"field_of_view", "safety.view_margin_px"},
    {"rotation_speed", "safety.rotation_speed"},
}};

constexpr std::array<Entry, kNumIntakes> kIntakeTable{{
    {"none", ""},
    {"taken", ""},
    {"not_found", ""},
    {"wrong_kind", "target.kind"},
    {"from_future", "camera.latency_ms"},
    {"too_old", ""},
    {"stuck_picture", "servo.stuck_shift_px"},
    {"out_of_region", "servo.target_region"},
    {"outlier", "servo.gate_sigma"},
}};

// A value from a file or a link may be outside the enumeration.
template <typename Table, typename Enumerator>
Entry EntryOf(const Table& table, Enumerator which) noexcept {
  const auto k = static_cast<std::size_t>(which);
  return k < table.size() ? table[k] : Entry{"unknown", ""};
}

}  // namespace

const char* Name(Mode mode) noexcept {
  switch (mode) {
    case Mode::kBoot: return "boot";
    case Mode::kHold: return "hold";
    case Mode::kTrack: return "track";
    case Mode::kCoast: return "coast";
    case Mode::kFault: return "fault";
    case Mode::kMove: return "move";
  }
  return "unknown";
}

const char* Name(HoldReason reason) noexcept {
  switch (reason) {
    case HoldReason::kNone: return "none";
    case HoldReason::kNotAsked: return "not_asked";
    case HoldReason::kNoTarget: return "no_target";
    case HoldReason::kTargetLost: return "target_lost";
    case HoldReason::kGoalUnreachable: return "goal_unreachable";
    case HoldReason::kMotionDone: return "motion_done";
    case HoldReason::kMotionRefused: return "motion_refused";
    case HoldReason::kEyeDoubted: return "eye_doubted";
    case HoldReason::kNotFollowed: return "not_followed";
  }
  return "unknown";
}

const char* Name(TuningResult result) noexcept {
  switch (result) {
    case TuningResult::kNone: return "none";
    case TuningResult::kTaken: return "taken";
    case TuningResult::kUnknownKey: return "unknown_key";
    case TuningResult::kNotFinite: return "not_finite";
    case TuningResult::kOutOfRange: return "out_of_range";
    case TuningResult::kInconsistent: return "inconsistent";
  }
  return "unknown";
}

const char* Name(Fault fault) noexcept { return EntryOf(kFaultTable, fault).name; }
const char* Name(Limit limit) noexcept { return EntryOf(kLimitTable, limit).name; }
const char* Name(Intake intake) noexcept { return EntryOf(kIntakeTable, intake).name; }

const char* Words(HoldReason reason) noexcept {
  switch (reason) {
    case HoldReason::kNone: return "the servo does not hold";
    case HoldReason::kNotAsked: return "tracking was not requested";
    case HoldReason::kNoTarget: return "no target was found yet";
    case HoldReason::kTargetLost: return "the target was lost";
    case HoldReason::kGoalUnreachable: return "limits keep the arm from the goal";
    case HoldReason::kMotionDone: return "the commanded motion has ended";
    case HoldReason::kMotionRefused: return "the commanded motion was refused";
    case HoldReason::kEyeDoubted: return "the picture contradicts the hand's motion, or following it fails";
    case HoldReason::kNotFollowed: return "the arm did not follow the commanded motion";
  }
  return "the reason is unknown";
}

const char* Words(Fault fault) noexcept {
  switch (fault) {
    case Fault::kNone: return "no fault";
    case Fault::kArmLost: return "the arm returned errors, or nothing";
    case Fault::kArmStale: return "the arm's states, or a joint's reading, stood still";
    case Fault::kNonFiniteSensor: return "a sensor value was not finite";
    case Fault::kNonFiniteFeature: return "a value from vision was not finite";
    case Fault::kNonFiniteControl: return "a value of the control law was not finite";
    case Fault::kDeadlineMissed: return "too many ticks in a row were missed";
    case Fault::kJointPosition: return "a joint was outside its range";
    case Fault::kJointVelocity: return "a joint's velocity exceeded its limit, or jumped";
    case Fault::kNotFollowing: return "a joint did not follow its reference";
    case Fault::kContact: return "an external force exceeded its limit";
  }
  return "an unknown fault";
}

const char* Words(Intake intake) noexcept {
  switch (intake) {
    case Intake::kNone: return "not arrived";
    case Intake::kTaken: return "taken for the estimate";
    case Intake::kNotFound: return "without the target";
    case Intake::kWrongKind: return "of another target";
    case Intake::kFromFuture: return "stamped in the future";
    case Intake::kTooOld: return "too old";
    case Intake::kStuckPicture: return "from a stuck picture";
    case Intake::kOutOfRegion: return "outside the target region";
    case Intake::kOutlier: return "rejected as outlier";
  }
  return "with an unknown outcome";
}

const char* Words(TuningResult result) noexcept {
  switch (result) {
    case TuningResult::kNone: return "nothing was requested";
    case TuningResult::kTaken: return "taken";
    case TuningResult::kUnknownKey: return "no such key changes in motion";
    case TuningResult::kNotFinite: return "the value is not finite";
    case TuningResult::kOutOfRange: return "the value is outside the key's range";
    case TuningResult::kInconsistent: return "the value contradicts another key";
  }
  return "an unknown answer";
}

const char* Key(Fault fault) noexcept { return EntryOf(kFaultTable, fault).key; }
const char* Key(Limit limit) noexcept { return EntryOf(kLimitTable, limit).key; }
const char* Key(Intake intake) noexcept { return EntryOf(kIntakeTable, intake).key; }

}  // namespace fovea::hal
