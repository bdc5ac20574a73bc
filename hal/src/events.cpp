// SPDX-License-Identifier: Apache-2.0
// One table per enumeration, with name, key and words side by side.
#include "fovea/hal/events.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace fovea::hal {
namespace {

struct Entry {
  const char* name = nullptr;
  const char* key = "";
  const char* words = "";
};

// An entry per enumerator, in the order of the enumeration. The last entry is for all values outside it,
// which a file or a link may contain.
template <int kNumEnumerators>
using Table = std::array<Entry, std::size_t{kNumEnumerators} + 1>;

constexpr Table<kNumModes> kModeTable{{
    {"boot"},
    {"hold"},
    {"track"},
    {"coast"},
    {"fault"},
    {"move"},
    {"unknown"},
}};

constexpr Table<kNumHoldReasons> kHoldReasonTable{{
    {"none", "", "the servo does not hold"},
    {"not_asked", "", "tracking was not requested"},
    {"no_target", "", "no target was found yet"},
    {"target_lost", "", "the target was lost"},
    {"goal_unreachable", "", "limits keep the arm from the goal"},
    {"motion_done", "", "the commanded motion has ended"},
    {"motion_refused", "", "the commanded motion was refused"},
    {"eye_doubted", "", "the picture contradicts the hand's motion, or following it fails"},
    {"not_followed", "", "the arm did not follow the commanded motion"},
    {"unknown", "", "the reason is unknown"},
}};

constexpr Table<kNumFaults> kFaultTable{{
    {"none", "", "no fault"},
    {"arm_lost", "safety.arm_lost_ticks", "the arm returned errors, or nothing"},
    {"arm_stale", "safety.arm_lost_ticks", "the arm's states, or a joint's reading, stood still"},
    {"non_finite_sensor", "safety.non_finite_ticks", "a sensor value was not finite"},
    {"non_finite_feature", "", "a value from vision was not finite"},
    {"non_finite_control", "", "a value of the control law was not finite"},
    {"deadline_missed", "safety.missed_ticks", "too many ticks in a row were missed"},
    {"joint_position", "arm.model", "a joint was outside its range"},
    {"joint_velocity", "arm.model", "a joint's velocity exceeded its limit, or jumped"},
    {"not_following", "safety.following_error", "a joint did not follow its reference"},
    {"contact", "safety.contact_torque_fraction", "an external force exceeded its limit"},
    {"unknown", "", "an unknown fault"},
}};

constexpr Table<kNumLimits> kLimitTable{{
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
    {"unknown"},
}};

constexpr Table<kNumIntakes> kIntakeTable{{
    {"none", "", "not arrived"},
    {"taken", "", "taken for the estimate"},
    {"not_found", "", "without the target"},
    {"wrong_kind", "target.kind", "of another target"},
    {"from_future", "camera.latency_ms", "stamped in the future"},
    {"too_old", "", "too old"},
    {"stuck_picture", "servo.stuck_shift_px", "from a stuck picture"},
    {"out_of_region", "servo.target_region", "outside the target region"},
    {"outlier", "servo.gate_sigma", "rejected as outlier"},
    {"unknown", "", "with an unknown outcome"},
}};

constexpr Table<kNumTuningResults> kTuningResultTable{{
    {"none", "", "nothing was requested"},
    {"taken", "", "taken"},
    {"unknown_key", "", "no such key changes in motion"},
    {"not_finite", "", "the value is not finite"},
    {"out_of_range", "", "the value is outside the key's range"},
    {"inconsistent", "", "the value contradicts another key"},
    {"unknown", "", "an unknown answer"},
}};

constexpr Table<kNumWays> kWayTable{{
    {"law"},
    {"await_plan"},
    {"plan"},
    {"unknown"},
}};

constexpr Table<kNumPlanEvents> kPlanEventTable{{
    {"none", "", "nothing happened to a plan"},
    {"asked", "", "a plan to the goal is asked for"},
    {"taken", "", "a plan came, and the arm follows it"},
    {"no_motion", "", "no plan: the visual law goes on alone"},
    {"stale", "", "a plan came for another start or target, and is refused"},
    {"late", "", "no plan came in time: the visual law goes on alone"},
    {"held", "", "limits hold the arm up on its plan: a new one is asked for"},
    {"target_moved", "", "the target is elsewhere than planned: the plan is dropped"},
    {"done", "", "the plan's end is reached: the visual law goes on"},
    {"unknown", "", "an unknown event of a plan"},
}};

template <std::size_t kSize>
constexpr bool IsComplete(const std::array<Entry, kSize>& table) {
  return std::all_of(table.begin(), table.end(), [](const Entry& entry) { return entry.name != nullptr; });
}
static_assert(IsComplete(kModeTable) && IsComplete(kHoldReasonTable) && IsComplete(kFaultTable) &&
              IsComplete(kLimitTable) && IsComplete(kIntakeTable) && IsComplete(kTuningResultTable) &&
              IsComplete(kWayTable) && IsComplete(kPlanEventTable));

template <std::size_t kSize, typename Enumerator>
const Entry& EntryOf(const std::array<Entry, kSize>& table, Enumerator which) noexcept {
  return table[std::min(static_cast<std::size_t>(which), kSize - 1)];
}

}  // namespace

const char* Name(Mode mode) noexcept { return EntryOf(kModeTable, mode).name; }
const char* Name(HoldReason reason) noexcept { return EntryOf(kHoldReasonTable, reason).name; }
const char* Name(TuningResult result) noexcept { return EntryOf(kTuningResultTable, result).name; }
const char* Name(Fault fault) noexcept { return EntryOf(kFaultTable, fault).name; }
const char* Name(Limit limit) noexcept { return EntryOf(kLimitTable, limit).name; }
const char* Name(Intake intake) noexcept { return EntryOf(kIntakeTable, intake).name; }

const char* Words(HoldReason reason) noexcept { return EntryOf(kHoldReasonTable, reason).words; }
const char* Words(Fault fault) noexcept { return EntryOf(kFaultTable, fault).words; }
const char* Words(Intake intake) noexcept { return EntryOf(kIntakeTable, intake).words; }

const char* Name(Way way) noexcept { return EntryOf(kWayTable, way).name; }
const char* Name(PlanEvent event) noexcept { return EntryOf(kPlanEventTable, event).name; }

const char* Words(PlanEvent event) noexcept { return EntryOf(kPlanEventTable, event).words; }
const char* Words(TuningResult result) noexcept { return EntryOf(kTuningResultTable, result).words; }

const char* Key(Fault fault) noexcept { return EntryOf(kFaultTable, fault).key; }
const char* Key(Limit limit) noexcept { return EntryOf(kLimitTable, limit).key; }
const char* Key(Intake intake) noexcept { return EntryOf(kIntakeTable, intake).key; }

}  // namespace fovea::hal
