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

const char* Name(Fault fault) noexcept { return EntryOf(kFaultTable, fault).name; }
const char* Name(Limit limit) noexcept { return EntryOf(kLimitTable, limit).name; }
const char* Name(Intake intake) noexcept { return EntryOf(kIntakeTable, intake).name; }
const char* Key(Fault fault) noexcept { return EntryOf(kFaultTable, fault).key; }
const char* Key(Limit limit) noexcept { return EntryOf(kLimitTable, limit).key; }
const char* Key(Intake intake) noexcept { return EntryOf(kIntakeTable, intake).key; }

}  // namespace fovea::hal
