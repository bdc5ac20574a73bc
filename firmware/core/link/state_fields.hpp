// SPDX-License-Identifier: Apache-2.0
// The fields of the servo's state that a tick takes from the previous tick, in groups. State that every tick
// computes before it uses it (poses, dynamics, Jacobians, the prediction, the law's task) is not included.
// Add a new field of a struct here too; state_test.cpp checks the structs' sizes.
#pragma once

#include <cstdint>
#include <limits>

#include "firmware/core/link/estimate_fields.hpp"
#include "firmware/core/link/fields.hpp"
#include "firmware/core/link/tick_fields.hpp"
#include "firmware/core/task/servo_task.hpp"

namespace fovea::link {

// When a group can change, so that the digest must include it.
enum class Pace : std::uint8_t {
  kTick,         // in every tick
  kMeasurement,  // in a tick that takes a measurement, and while its poses are compared
  kSeeking,      // while the servo tracks a target and searches for a posture
  kMoving,       // in mode Move
  kTuning,       // in a tick with a request to change a key, and while a key moves
  kFollows,      // follows from inputs and the other groups alone
};

template <class Archive, class T>
void InputStateFields(Archive& a, T& s) noexcept {
  a(s.has_state);
  a(s.stamp_ns);
  a(s.sequence);
  a.Int(s.bad_ticks);
  a.Int(s.sound_ticks);
  a.Int(s.non_finite_ticks);
  a.Int(s.jumps);
  a(s.jumped);
  EachOf(a, s.q);
  EachOf(a, s.dq);
  EachOf(a, s.tau_applied);
}

template <class Archive, class T>
void EncoderWatchFields(Archive& a, T& w) noexcept {
  a(w.drove);
  for (auto& joint : w.joints) {
    a(joint.residual);
    a(joint.mean);
    a.Int(joint.ticks);
    a(joint.q);
    a(joint.q_reference);
    a(joint.dq);
    a(joint.speed);
    a(joint.way);
    a(joint.travel);
    a.Int(joint.unseen_ticks);
    a(joint.q_last);
    a(joint.dq_last);
    a(joint.change_last);
    a.Int(joint.flickers);
    a.Int(joint.same_ticks);
    a(joint.is_noisy);
    a(joint.noise2);
    a.Int(joint.noise_ticks);
  }
}

template <class Archive, class T>
void ModeFields(Archive& a, T& s) noexcept {
  a.Choice(s.mode.mode, hal::kNumModes);
  a.Choice(s.mode.hold_reason, hal::kNumHoldReasons);
  a.Choice(s.mode.fault, hal::kNumFaults);
  a(s.mode.track_asked);
  a(s.mode.motion_barred);
  a.Int(s.fault_joint);
  a(s.mode_since_ns);
  a(s.track_since_ns);
  a(s.reach.blocked_ns);
  Entries(a, s.reach.p_BO_unreachable);
  a(s.reach.planner_was_late);
  Entries(a, s.R_BC_held);
}

// Without the note's event, which each tick writes anew, and without `X_BC_end` and `pull`, which follow from
// q_end.
template <class Archive, class T>
void WayFields(Archive& a, T& w) noexcept {
  WayNoteFields(a, w.note);
  a.Count(w.turn, 3);
  a(w.turn_known);
  a(w.is_fresh);
  a(w.is_new_goal);
  a(w.is_there);
  a(w.keeps_posture);
  a(w.since_ns);
  a(w.asked_ns);
  a(w.stalled_ns);
  a(w.held_ns);
  a(w.horizon_ns);
  a(w.taken_ns);
  a(w.late_ns);
  a(w.again_ns);
  a(w.pace);
  a(w.least_off);
  a(w.t);
  a(w.trust);
  a(w.swing.angle);
  a(w.swing.pace);
  a(w.swing.side);
  a(w.swing.barred_ns);
  SizedEntries(a, w.shift);
  SizedEntries(a, w.q_end);
  Entries(a, w.p_BO_end);
}

// 0: nothing is received, or what came was dropped.
template <class Archive>
void PlansFields(Archive& a, const trajectory::PlanReceiver& plans) noexcept {
  const std::int32_t numbers = plans.received() + 1;
  a.Count(numbers, trajectory::Plan::kMostNumbers + 1);
  if (numbers > 0) {
    PlanHeadFields(a, plans.plan());
    Row(a, plans.plan().points.data(), static_cast<std::size_t>(plans.received()));
  }
}
template <class Archive>
void PlansFields(Archive& a, trajectory::PlanReceiver& plans) noexcept {
  trajectory::Plan plan;
  std::int32_t numbers = 0;
  a.Count(numbers, trajectory::Plan::kMostNumbers + 1);
  if (numbers > 0) {
    PlanHeadFields(a, plan);
    Row(a, plan.points.data(), static_cast<std::size_t>(numbers - 1));
  }
  plans.Restore(plan, numbers - 1);
}

template <class Archive, class T>
void ResolvedFields(Archive& a, T& r) noexcept {
  SizedEntries(a, r.dq);
  a(r.finite);
  a(r.limits);
  a(r.watch.sigma);
}

template <class Archive, class T>
void ReferenceFields(Archive& a, T& r) noexcept {
  SizedEntries(a, r.q);
  SizedEntries(a, r.dq);
  SizedEntries(a, r.ddq);
}

template <class Archive, class T>
void MotionStateFields(Archive& a, T& m) noexcept {
  MotionFields(a, m.goal);
  MotionFields(a, m.done);
  a(m.start_ns);
  PoseFields(a, m.X_BE);
  ResolvedFields(a, m.resolved);
  a(m.refused);
  SizedEntries(a, m.off);
}

// Without the note, which each tick writes anew.
template <class Archive, class T>
void TuningStateFields(Archive& a, T& s) noexcept {
  a(s.active);
  for (auto& ramp : s.ramps) {
    a(ramp.asked);
    if (ramp.asked) {
      a(ramp.from);
      a(ramp.to);
      a.Int(ramp.ticks);
    }
  }
}

template <class Archive, class T>
void TorqueFields(Archive& a, T& s) noexcept {
  SizedEntries(a, s.law_state.integral);
  SizedEntries(a, s.law_state.cut);
  a.Choice(s.law_state.kind, config::kNumMotionLaws);
  SizedEntries(a, s.law_state.step);
  a(s.law_state.since_change_s);
  SizedEntries(a, s.tau);
  a.Choice(s.stop.stage, guard::FaultStop::kNumStages);
  a(s.stop.speed_due);
}

// Access to the private fields of the state's classes.
struct StateAccess {
  // From the oldest entry; the ring's start does not matter.
  template <class Archive>
  static void Fields(Archive& a, const estimate::JointHistory& history) noexcept {
    a.Count(history.size_, estimate::JointHistory::kCapacity);
    for (int i = 0; i < history.size_; ++i) {
      const estimate::JointHistory::Entry& entry = history.FromOldest(i);
      a(entry.stamp_ns);
      link::SizedEntries(a, entry.q);
    }
  }
  template <class Archive>
  static void Fields(Archive& a, estimate::JointHistory& history) noexcept {
    int size = 0;
    a.Count(size, estimate::JointHistory::kCapacity);
    history.Clear();
    for (int i = 0; i < size; ++i) {
      estimate::JointHistory::Entry entry;
      a(entry.stamp_ns);
      link::SizedEntries(a, entry.q);
      history.Push(entry.stamp_ns, entry.q);
    }
  }

  template <class Archive, class T>
  static void MoveFields(Archive& a, T& move) noexcept {
    a.Count(move.num_axes_, trajectory::SynchronisedMove::kMaxAxes);
    a(move.duration_s_);
    a(move.straight_);
    for (auto& axis : move.moves_) {
      for (auto& phase : axis.phases) {
        a(phase.start_s);
        a(phase.duration_s);
        a(phase.jerk);
        a(phase.start.x);
        a(phase.start.v);
        a(phase.start.a);
      }
      a.Count(axis.num_phases, trajectory::AxisMove::kMaxPhases);
      a(axis.duration_s);
      a(axis.goal_x);
    }
    link::EachOf(a, move.goal_);
    link::EachOf(a, move.way_);
  }
  template <class Archive, class T>
  static void PlanFields(Archive& a, T& motion) noexcept {
    MoveFields(a, motion.joints.move_);
    MoveFields(a, motion.pose);
  }
};

// Calls `visit(pace, name, fields)` for each group of `state`, in order. `fields(archive)` visits its fields.
template <class State, class Visit>
void EachGroup(State& s, const Visit& visit) noexcept {
  visit(Pace::kTick, "tick", [&s](auto& a) {
    a(s.tick);
    a(s.now_ns);
  });
  visit(Pace::kTick, "inputs", [&s](auto& a) { InputStateFields(a, s.inputs); });
  visit(Pace::kTick, "contact", [&s](auto& a) {
    a(s.contact.started);
    SizedEntries(a, s.contact.residual);
    a(s.contact.carried);
    a.Int(s.push.ticks);
    SizedEntries(a, s.push.followed);
  });
  visit(Pace::kTick, "encoder watch", [&s](auto& a) {
    EncoderWatchFields(a, s.encoders);
    a(s.blind);
  });
  visit(Pace::kFollows, "momentum", [&s](auto& a) {
    SizedEntries(a, s.contact.M_before);
    SizedEntries(a, s.contact.p_before);
  });
  visit(Pace::kFollows, "joint history", [&s](auto& a) { StateAccess::Fields(a, s.predict.history); });
  visit(Pace::kMeasurement, "stuck picture", [&s](auto& a) {
    a(s.predict.picture.started);
    a(s.predict.picture.since_ns);
    PoseFields(a, s.predict.picture.X_BC);
    Entries(a, s.predict.picture.p_CO_C);
    SizedEntries(a, s.predict.picture.xy);
  });
  visit(Pace::kMeasurement, "knowledge", [&s](auto& a) {
    a.Choice(s.predict.knowledge, estimate::kNumKnowledge);
    a(s.predict.accepted_stamp_ns);
    a(s.predict.lateness.known);
    a(s.predict.lateness.stamp_ns);
    a(s.predict.lateness.error.mean_s);
    a(s.predict.lateness.error.sigma_s);
    a(s.predict.belief.stamp_ns);
    PoseFields(a, s.predict.belief.motion.X_BO);
    Entries(a, s.predict.belief.motion.v_BO_B);
    Entries(a, s.predict.belief.motion.w_BO_B);
  });
  visit(Pace::kTick, "eye watch", [&s](auto& a) {
    a(s.eye.has_last);
    PoseFields(a, s.eye.X_BC_last);
    Entries(a, s.eye.p_CO_C_last);
    EachOf(a, s.eye.predicted);
    EachOf(a, s.eye.seen);
    a(s.eye.predicted2);
    a(s.eye.seen2);
    a(s.eye.along);
    a(s.eye.aside);
    a(s.eye.by_axis2);
    a.Int(s.eye.shifts);
    a(s.eye.least_error);
    a(s.eye.way);
    a(s.eye.suspected);
    a(s.eye.doubted);
  });
  visit(Pace::kMeasurement, "target filter", [&s](auto& a) {
    TargetFilterFields(a, s.predict.filter);
    PoseFields(a, s.predict.X_CO_meas);
  });
  visit(Pace::kMeasurement, "pose hypotheses",
        [&s](auto& a) { PoseHypothesesFields(a, s.predict.hypotheses); });
  visit(Pace::kTick, "mode", [&s](auto& a) { ModeFields(a, s); });
  visit(Pace::kSeeking, "way to the goal", [&s](auto& a) { WayFields(a, s.way); });
  visit(Pace::kFollows, "end of the way", [&s](auto& a) {
    PoseFields(a, s.way.X_BC_end);
    SizedEntries(a, s.way.pull);
  });
  visit(Pace::kFollows, "plan", [&s](auto& a) { PlansFields(a, s.plans); });
  visit(Pace::kTick, "resolved motion", [&s](auto& a) { ResolvedFields(a, s.resolved); });
  visit(Pace::kTick, "reference", [&s](auto& a) {
    ReferenceFields(a, s.reference);
    a(s.holds);
  });
  visit(Pace::kMoving, "commanded motion", [&s](auto& a) { MotionStateFields(a, s.motion); });
  visit(Pace::kFollows, "planned motion", [&s](auto& a) { StateAccess::PlanFields(a, s.motion); });
  visit(Pace::kTick, "limits", [&s](auto& a) { a(s.limits); });
  visit(Pace::kTick, "torque", [&s](auto& a) { TorqueFields(a, s); });
  visit(Pace::kTuning, "tuning", [&s](auto& a) { TuningStateFields(a, s.tuning); });
}

}  // namespace fovea::link
