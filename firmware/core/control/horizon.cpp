// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/horizon.hpp"

#include "firmware/core/control/count_tick.hpp"
#include "firmware/core/control/visual_laws.hpp"

namespace fovea::control {
namespace {

constexpr std::int64_t kEveryNs = 40 * hal::kNsPerMs;    // between requests, if they are answered
constexpr std::int64_t kLostNs = 200 * hal::kNsPerMs;    // an answer that takes longer does not come
constexpr std::int64_t kOldestNs = 300 * hal::kNsPerMs;  // of a horizon that is still followed
constexpr std::int64_t kArrivesNs = 5 * hal::kNsPerMs;   // a horizon's parts take no longer
constexpr double kMostOff = 0.05;   // a horizon that begins to be followed is at most so far off [rad, m]
constexpr double kHardly = 0.005;   // a horizon that ends nearer than this hardly moves [rad, m]
constexpr double kBackGain = 10.0;  // back to the horizon [1/s]
constexpr double kLeastGain = 0.5;  // with a lower one the error falls for longer than a horizon sees [1/s]

// Into a horizon that was asked for at `stamp_ns`: it begins with the reference after that tick [s].
double TimeInto(std::int64_t stamp_ns, const WaySight& sight) noexcept {
  return static_cast<double>(sight.now_ns - stamp_ns - hal::kTickPeriodNs) /
         static_cast<double>(hal::kNsPerSecond);
}

double OffFrom(const trajectory::Plan& plan, double t, const WaySight& sight) noexcept {
  trajectory::Reference at;
  plan.At(t, at);
  return (at.q - sight.reference.q).lpNorm<Eigen::Infinity>();
}

// Whether the law has steered alone for long enough to have begun smoothly, and is one that a horizon can
// replace.
bool IsTime(const config::ServoConfig& config, const WaySight& sight, const WayToGoal& way) noexcept {
  const double since_s =
      static_cast<double>(sight.now_ns - way.since_ns) / static_cast<double>(hal::kNsPerSecond);
  return since_s >= config.law.smooth_start_s && config.law.lambda >= kLeastGain && sight.is_seen &&
         sight.is_told_apart && !IsMoving(config, sight);
}

// Says once that the planner is late: of the first request, or when the last horizon has become too old.
void NoteLate(WayToGoal& way) noexcept {
  way.note.event = hal::PlanEvent::kLate;
  way.taken_ns = way.asked_ns;
}

void AskInTime(const WaySight& sight, WayToGoal& way) noexcept {
  const std::int64_t since_ns = sight.now_ns - way.asked_ns;
  if (way.asked_ns >= 0 && since_ns < (sight.has_answer ? kEveryNs : kLostNs)) {
    return;
  }
  if (way.asked_ns >= 0 && !sight.has_answer && way.taken_ns < 0) {
    NoteLate(way);
  }
  Ask(sight, way);
}

// The newest horizon, in the tick in which all of it is there. After a whole plan the law keeps to its goal
// among a square's four, and so must a horizon.
void TakeHorizon(const config::ServoConfig& config, const WaySight& sight, const trajectory::Plan& plan,
                 WayToGoal& way) noexcept {
  way.taken_ns = plan.stamp_ns;
  way.note.outcome = static_cast<std::int32_t>(plan.outcome);
  const bool is_sound = plan.IsFound() && plan.num_joints == config.arm.num_joints &&
                        (plan.turn == way.turn || !way.keeps_posture);
  const bool fits = is_sound && !IsElsewhere(config, sight, plan) &&
                    OffFrom(plan, TimeInto(plan.stamp_ns, sight), sight) < kMostOff;
  if (is_sound && !fits) {
    way.note.event = hal::PlanEvent::kStale;
  }
  way.horizon_ns = fits ? plan.stamp_ns : -1;
  way.turn = fits ? plan.turn : way.turn;
  way.held_ns = 0;
}

}  // namespace

bool FollowHorizon(const config::ServoConfig& config, const WaySight& sight,
                   const trajectory::PlanReceiver& plans, WayToGoal& way, PlanStep& step) noexcept {
  if (!LineOf(config.law.law).predicts || way.note.way != hal::Way::kLaw) {
    return false;
  }
  const trajectory::Plan& plan = plans.plan();
  if (sight.has_answer && plan.stamp_ns == way.asked_ns && plan.stamp_ns != way.taken_ns) {
    TakeHorizon(config, sight, plan, way);
  }
  if (IsTime(config, sight, way)) {
    AskInTime(sight, way);
  }
  if (way.horizon_ns < 0 || IsMoving(config, sight)) {
    way.horizon_ns = -1;
    return false;
  }
  const bool is_there = plans.IsWhole() && plan.stamp_ns == way.horizon_ns;
  CountTick(!is_there, way.held_ns);
  if (way.held_ns > kArrivesNs) {  // a part of the next one was lost: it is asked for anew
    way.horizon_ns = -1;
    way.asked_ns = -1;
    return false;
  }
  if (sight.now_ns - way.horizon_ns > kOldestNs) {
    way.horizon_ns = -1;
    if (sight.is_seen && !sight.has_answer) {
      NoteLate(way);
    }
    return false;
  }
  const double t = TimeInto(way.horizon_ns, sight);
  // Near its goal, and where limits stop it, a horizon hardly moves. There the law has the last word: it
  // comes nearer, or pushes against the limit, which is how the servo finds out that the goal is not
  // reachable.
  if (is_there && OffFrom(plan, plan.Duration(), sight) < kHardly) {
    return false;
  }
  trajectory::Reference at = sight.reference;
  model::VecN behind = model::VecN::Zero(at.q.size());
  if (is_there) {
    plan.At(t, at);
    behind = at.q - sight.reference.q;
    plan.At(t + hal::kTickPeriodS, at);
  } else {  // the next one comes in parts, and the motion goes on as it is
    at.dq += hal::kTickPeriodS * at.ddq;
  }
  step.task.v = at.dq + kBackGain * behind;
  step.task.J.setIdentity(at.q.size(), at.q.size());
  step.task.dq_0.setZero(at.q.size());
  step.task.weight.setOnes(at.q.size());
  step.ddq = at.ddq;
  return true;
}

}  // namespace fovea::control
