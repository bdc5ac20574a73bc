// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/axis_move.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/trajectory/bracketed_root.hpp"

namespace fovea::trajectory {
namespace {

// A stop that ends this close to the goal, relative to the lengths involved, ends there.
constexpr double kRounding = 2e-15;

// Writes the phases one after the other.
class MoveWriter {
 public:
  MoveWriter(const AxisState& start, double goal_x) noexcept : now_(start) { move_.goal_x = goal_x; }

  [[nodiscard]] const AxisState& Now() const noexcept { return now_; }
  [[nodiscard]] double Time() const noexcept { return time_s_; }

  void Append(double jerk, double duration_s) noexcept {
    if (duration_s > 0.0) {
      Begin(jerk, now_, duration_s);
      now_ = After(now_, jerk, duration_s);
    }
  }

  // Appends `change` up to the release of its acceleration's peak; all of it; its first `duration_s`.
  void AppendToPeak(const VelocityChange& change) noexcept {
    for (int k = 0; k < VelocityChange::kRelease; ++k) {
      const JerkPhase& phase = change.phases[static_cast<std::size_t>(k)];
      Append(phase.jerk, phase.duration_s);
    }
  }
  void Append(const VelocityChange& change) noexcept {
    AppendToPeak(change);
    Append(change.phases[VelocityChange::kRelease].jerk, change.phases[VelocityChange::kRelease].duration_s);
    now_.v = change.v_end;
    now_.a = 0.0;
  }
  void AppendPart(const VelocityChange& change, double duration_s) noexcept {
    double left = duration_s;
    for (const JerkPhase& phase : change.phases) {
      Append(phase.jerk, std::min(left, phase.duration_s));
      left = std::max(left - phase.duration_s, 0.0);
    }
  }

  // Appends the last change, to rest at the goal, computed backwards from there.
  [[nodiscard]] AxisMove Finish(const VelocityChange& stop) noexcept {
    std::array<AxisState, VelocityChange::kNumPhases> starts;
    AxisState state{move_.goal_x, 0.0, 0.0};
    for (std::size_t k = starts.size(); k-- > 0;) {
      state = After(state, stop.phases[k].jerk, -stop.phases[k].duration_s);
      starts[k] = state;
    }
    for (std::size_t k = 0; k < starts.size(); ++k) {
      if (stop.phases[k].duration_s > 0.0) {
        // A move that begins with the stop begins at the axis's state.
        Begin(stop.phases[k].jerk, move_.num_phases == 0 ? now_ : starts[k], stop.phases[k].duration_s);
      }
    }
    move_.duration_s = time_s_;
    Begin(0.0, {move_.goal_x, 0.0, 0.0}, 0.0);
    return move_;
  }

 private:
  void Begin(double jerk, const AxisState& start, double duration_s) noexcept {
    move_.phases[static_cast<std::size_t>(move_.num_phases++)] = {time_s_, duration_s, jerk, start};
    time_s_ += duration_s;
  }

  AxisMove move_;
  AxisState now_;
  double time_s_ = 0.0;
};

VelocityChange ChangeFrom(const AxisState& state, double v1, const AxisLimits& limits) noexcept {
  return PlanVelocityChange(state.v, state.a, v1, limits);
}

// Of `t` seconds of forward acceleration, the time until it reaches its limit.
double RampTime(const AxisState& state, double t, const AxisLimits& limits) noexcept {
  return std::min(t, std::max((limits.a_max - state.a) / limits.j_max, 0.0));
}

// `state` after `t` seconds of forward jerk, with the acceleration held once it reaches its limit.
AxisState Accelerate(const AxisState& state, double t, const AxisLimits& limits) noexcept {
  const double ramp_s = RampTime(state, t, limits);
  return After(After(state, limits.j_max, ramp_s), 0.0, t - ramp_s);
}

// How long a forward change accelerates before it releases.
double ForwardTime(const VelocityChange& change) noexcept {
  return change.phases[VelocityChange::kRamp].duration_s + change.phases[VelocityChange::kHold].duration_s;
}

// The fastest move to rest `distance` forward of a start at x = 0. The start is within the limits and would
// stop short of `distance`.
struct Sprint {
  double accelerate_s = 0.0;  // forward
  double cruise_s = -1.0;     // at v_max; negative if that is not reached
  double duration_s = 0.0;
};

Sprint FindSprint(const AxisState& start, double distance, const AxisLimits& limits) noexcept {
  const VelocityChange rise = ChangeFrom(start, limits.v_max, limits);
  const VelocityChange fall = PlanVelocityChange(limits.v_max, 0.0, 0.0, limits);
  const double cruise = distance - rise.Travel() - fall.Travel();
  Sprint sprint;
  if (cruise >= 0.0) {
    sprint.cruise_s = cruise / limits.v_max;
    sprint.duration_s = rise.Duration() + sprint.cruise_s + fall.Duration();
    return sprint;
  }
  // How far beyond `distance` the axis stops after forward acceleration for `s`.
  const auto beyond = [&](double s) noexcept {
    const AxisState state = Accelerate(start, s, limits);
    return state.x + ChangeFrom(state, 0.0, limits).Travel() - distance;
  };
  // A start that settles at v_max, or above it by rounding, can only release its braking.
  const double most =
      rise.direction > 0.0 ? ForwardTime(rise) : rise.phases[VelocityChange::kRelease].duration_s;
  sprint.accelerate_s = BracketedRoot(beyond, 0.0, beyond(0.0), most, -cruise);
  sprint.duration_s = sprint.accelerate_s +
                      ChangeFrom(Accelerate(start, sprint.accelerate_s, limits), 0.0, limits).Duration();
  return sprint;
}

// `state` relative to the axis's position, with `sign` as the forward direction.
AxisState Seen(const AxisState& state, double sign) noexcept { return {0.0, sign * state.v, sign * state.a}; }

VelocityChange Mirrored(VelocityChange change, double sign) noexcept {
  for (JerkPhase& phase : change.phases) {
    phase.jerk *= sign;
  }
  change.start.v *= sign;
  change.start.a *= sign;
  change.v_end *= sign;
  change.direction *= sign;
  return change;
}

// Brings a start beyond the limits back. Ends where the velocity would settle within its limit.
void AppendReturn(const AxisLimits& limits, MoveWriter& writer) noexcept {
  const double a = writer.Now().a;
  if (std::fabs(a) > limits.a_max) {
    writer.Append(std::copysign(limits.j_max, -a), (std::fabs(a) - limits.a_max) / limits.j_max);
  }
  const double v = SettledVelocity(writer.Now().v, writer.Now().a, limits.j_max);
  if (std::fabs(v) > limits.v_max) {
    writer.AppendToPeak(ChangeFrom(writer.Now(), std::copysign(limits.v_max, v), limits));
  }
}

// The task from the writer's state: rest `distance` forward, in the direction of `sign`, after `duration_s`.
struct Task {
  AxisLimits limits;
  double sign = 1.0;
  double distance = 0.0;
  double duration_s = 0.0;
};

AxisMove WriteSprint(const Task& task, const Sprint& sprint, MoveWriter& writer) noexcept {
  const AxisLimits& limits = task.limits;
  const AxisState start = Seen(writer.Now(), task.sign);
  if (sprint.cruise_s >= 0.0) {
    writer.Append(Mirrored(ChangeFrom(start, limits.v_max, limits), task.sign));
    writer.Append(0.0, sprint.cruise_s);
  } else {
    const double ramp_s = RampTime(start, sprint.accelerate_s, limits);
    writer.Append(task.sign * limits.j_max, ramp_s);
    writer.Append(0.0, sprint.accelerate_s - ramp_s);
  }
  return writer.Finish(ChangeFrom(writer.Now(), 0.0, limits));
}

// The cruise velocity, at most `v_high`, that gives the move its duration; negative if there is none.
double FindCruise(const AxisState& start, const Task& task, double v_high) noexcept {
  // Velocity times the excess of the duration: finite at zero, where it is the distance left after a stop.
  const auto excess = [&](double v) noexcept {
    const VelocityChange rise = ChangeFrom(start, v, task.limits);
    const VelocityChange fall = PlanVelocityChange(v, 0.0, 0.0, task.limits);
    return (rise.Duration() + fall.Duration() - task.duration_s) * v + task.distance - rise.Travel() -
           fall.Travel();
  };
  const double at_high = excess(v_high);
  return at_high <= 0.0 ? BracketedRoot(excess, 0.0, excess(0.0), v_high, at_high) : -1.0;
}

// The move that takes `task.duration_s`, which is longer than the sprint.
AxisMove WriteStretched(const Task& task, const Sprint& sprint, MoveWriter& writer) noexcept {
  const AxisLimits& limits = task.limits;
  const AxisState start = Seen(writer.Now(), task.sign);
  const AxisState top = Accelerate(start, sprint.accelerate_s, limits);
  const double v_top = sprint.cruise_s >= 0.0
                           ? limits.v_max
                           : std::min(SettledVelocity(top.v, top.a, limits.j_max), limits.v_max);
  const double v = FindCruise(start, task, v_top);
  if (v > 0.0) {
    const VelocityChange rise = ChangeFrom(start, v, limits);
    const VelocityChange fall = PlanVelocityChange(v, 0.0, 0.0, limits);
    const double cruise_s = task.duration_s - rise.Duration() - fall.Duration();
    if (cruise_s >= 0.0) {
      writer.Append(Mirrored(rise, task.sign));
      writer.Append(0.0, cruise_s);
      return writer.Finish(Mirrored(fall, task.sign));
    }
  }
  // There is none: brake for a while, then sprint.
  const VelocityChange stop = ChangeFrom(start, 0.0, limits);
  const auto sprint_after = [&](double brake_s) noexcept {
    const AxisState then = stop.At(brake_s);
    return FindSprint({0.0, then.v, then.a}, task.distance - then.x, limits);
  };
  const auto late = [&](double brake_s) noexcept {
    return brake_s + sprint_after(brake_s).duration_s - task.duration_s;
  };
  const double stop_s = stop.Duration();
  const double late_at_end = late(stop_s);
  double brake_s = stop_s;
  if (late_at_end >= 0.0) {
    brake_s = BracketedRoot(late, 0.0, sprint.duration_s - task.duration_s, stop_s, late_at_end);
    writer.AppendPart(Mirrored(stop, task.sign), brake_s);
  } else {
    // Even that arrives too early (no such case is known): wait where the stop ends.
    writer.Append(Mirrored(stop, task.sign));
    writer.Append(0.0, -late_at_end);
  }
  return WriteSprint(task, sprint_after(brake_s), writer);
}

}  // namespace

AxisState AxisMove::At(double t) const noexcept {
  if (!(t < duration_s)) {
    return {goal_x, 0.0, 0.0};
  }
  int k = 0;
  while (k + 1 < num_phases && phases[static_cast<std::size_t>(k + 1)].start_s <= t) {
    ++k;
  }
  const Phase& phase = phases[static_cast<std::size_t>(k)];
  return After(phase.start, phase.jerk, std::max(t - phase.start_s, 0.0));
}

AxisMove PlanAxisMove(const AxisState& start, double goal_x, const AxisLimits& limits,
                      double duration_s) noexcept {
  MoveWriter writer(start, goal_x);
  AppendReturn(limits, writer);
  const AxisState& now = writer.Now();
  const VelocityChange stop = ChangeFrom(now, 0.0, limits);
  const double beyond = goal_x - now.x - stop.Travel();
  const double stop_s = stop.Duration();
  const double scale =
      std::fabs(start.x) + std::fabs(goal_x) + stop_s * (std::fabs(now.v) + stop_s * std::fabs(now.a));
  AxisMove move;
  if (std::fabs(beyond) <= kRounding * scale) {
    move = writer.Finish(stop);
  } else {
    const double sign = beyond > 0.0 ? 1.0 : -1.0;
    const Task task{limits, sign, sign * (goal_x - now.x), duration_s - writer.Time()};
    const Sprint sprint = FindSprint(Seen(now, sign), task.distance, limits);
    move = task.duration_s > sprint.duration_s ? WriteStretched(task, sprint, writer)
                                               : WriteSprint(task, sprint, writer);
  }
  move.duration_s = std::max(move.duration_s, duration_s);
  return move;
}

}  // namespace fovea::trajectory
