// SPDX-License-Identifier: Apache-2.0
// The fields of a tick's inputs and outputs, in the order of the line.
#pragma once

#include "firmware/core/features/target_traits.hpp"
#include "firmware/core/link/fields.hpp"
#include "firmware/core/link/messages.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::link {

inline constexpr int kNumStatusCodes = 8;
inline constexpr int kNumRequests = 4;
inline constexpr int kNumMotionKinds = 6;
inline constexpr int kNumFeatureKinds = static_cast<int>(features::kTargets.size());

template <class Archive, class T>
void ArmStateFields(Archive& a, T& s) noexcept {
  a(s.stamp_ns);
  a(s.sequence);
  a.Count(s.num_joints, hal::kMaxJoints);
  EachOf(a, s.q);
  EachOf(a, s.dq);
  EachOf(a, s.tau_meas);
  EachOf(a, s.tau_applied);
}

template <class Archive, class T>
void MeasurementFields(Archive& a, T& m) noexcept {
  a(m.stamp_ns);
  a(m.sequence);
  a(m.same_for_ns);
  a.Choice(m.kind, kNumFeatureKinds);
  a(m.found);
  a(m.confidence);
  a.Count(m.dim, hal::kMaxFeatureDim);
  EachOf(a, m.s);
  EachOf(a, m.cov_s);
  a.Count(m.num_poses, hal::kMaxPoses);
  for (auto& pose : m.poses) {
    EachOf(a, pose.p_CO_C);
    EachOf(a, pose.q_CO);
    a.Int(pose.first);
  }
}

template <class Archive, class T>
void MotionFields(Archive& a, T& m) noexcept {
  a.Choice(m.kind, kNumMotionKinds);
  if (m.kind == moves::MotionKind::kNone) {
    return;
  }
  EachOf(a, m.q);
  EachOf(a, m.dq);
  EachOf(a, m.ddq);
  EachOf(a, m.p_BE);
  EachOf(a, m.quaternion_BE);
  EachOf(a, m.V_BE_B);
}

// The requests to the servo, without a key that changes.
template <class Archive, class T>
void DemandFields(Archive& a, T& in) noexcept {
  a.Choice(in.request, kNumRequests);
  MotionFields(a, in.motion);
  a(in.change_law);
  a.Choice(in.law, config::kNumMotionLaws);
}

template <class Archive, class T>
void TuningFields(Archive& a, T& t) noexcept {
  a.Int(t.key);
  if (t.IsAsked()) {
    a(t.value);
  }
}

template <class Archive, class T>
void PlanHeadFields(Archive& a, T& head) noexcept {
  a.Choice(head.outcome, static_cast<int>(trajectory::kPlanOutcomeWords.size()));
  a.Choice(head.blocker, hal::kNumLimits);
  a.Count(head.num_joints, hal::kMaxJoints);
  a.Int(head.num_points);
  a.Count(head.turn, 3);
  a(head.stamp_ns);
  a(head.period_s);
  EachOf(a, head.p_BO);
  EachOf(a, head.q_BO);
}

// Nothing but the count if there is no part.
template <class Archive, class T>
void PlanPartFields(Archive& a, T& part) noexcept {
  std::int32_t numbers = part.count + 1;
  a.Count(numbers, trajectory::PlanPart::kMostNumbers + 1);
  if constexpr (!std::is_const_v<T>) {
    part.count = numbers - 1;
  }
  if (part.IsThere()) {
    PlanHeadFields(a, part.head);
    a.Count(part.first, trajectory::Plan::kMostNumbers);
    Row(a, part.numbers.data(), static_cast<std::size_t>(part.count));
  }
}

// All inputs except the arm's status, whose text stays with its driver.
template <class Archive, class T>
void InputFields(Archive& a, T& in) noexcept {
  ArmStateFields(a, in.arm);
  a(in.has_feature);
  if (in.has_feature) {
    MeasurementFields(a, in.feature);
  }
  DemandFields(a, in);
  TuningFields(a, in.tuning);
  PlanPartFields(a, in.plan);
  a.Int(in.missed_ticks);
}

template <class Archive, class T>
void TuningNoteFields(Archive& a, T& note) noexcept {
  a.Choice(note.result, hal::kNumTuningResults);
  if (note.result != hal::TuningResult::kNone) {
    a.Int(note.key);
    a(note.before);
    a(note.asked);
  }
}

template <class Archive, class T>
void WayNoteFields(Archive& a, T& note) noexcept {
  a.Choice(note.way, hal::kNumWays);
  a.Choice(note.event, hal::kNumPlanEvents);
  a.Int(note.plans_asked);
  a.Int(note.tries);
  a.Int(note.outcome);
  EachOf(a, note.normal_B);
}

template <class Archive, class T>
void RecordFields(Archive& a, T& r) noexcept {
  a(r.tick);
  a(r.stamp_ns);
  a.Int(r.missed_ticks);
  a.Choice(r.intake, hal::kNumIntakes);
  TuningNoteFields(a, r.tuning);
  a.Choice(r.mode, hal::kNumModes);
  a.Choice(r.hold_reason, hal::kNumHoldReasons);
  a.Choice(r.fault, hal::kNumFaults);
  a.Int(r.fault_joint);
  a(r.limits_active);
  a(r.target_known);
  a(r.feature_age_ns);
  EachOf(a, r.p_BO);
  EachOf(a, r.q_BO);
  EachOf(a, r.v_BO);
  a(r.stamp_late_s);
  a(r.stamp_late_sigma_s);
  a.Count(r.dim, hal::kMaxFeatureDim);
  EachOf(a, r.s);
  EachOf(a, r.s_star);
  EachOf(a, r.e);
  EachOf(a, r.V_BC_C_cmd);
  WayNoteFields(a, r.way);
  EachOf(a, r.q_cmd);
  EachOf(a, r.dq_cmd);
  EachOf(a, r.ddq_cmd);
  EachOf(a, r.tau_ext);
  a(r.command.state_sequence);
  a.Count(r.command.num_joints, hal::kMaxJoints);
  EachOf(a, r.command.tau_cmd);
  a(r.command.engage_brakes);
}

template <class Archive, class T>
void LineFields(Archive& a, T& line) noexcept {
  a(line.damaged_frames);
  a(line.late_frames);
  a(line.silent_ticks);
  a(line.missed_ticks);
  a(line.lost_bytes);
  a(line.unsent_frames);
}

template <class Archive, class T>
void OutputFields(Archive& a, T& out) noexcept {
  RecordFields(a, out.record);
  EachOf(a, out.stage_counts);
  a(out.tick_counts);
  a(out.link_counts);
  a(out.periods_passed);
  a(out.stack_bytes);
  LineFields(a, out.line);
}

}  // namespace fovea::link
