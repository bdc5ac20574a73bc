// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/horizon.hpp"

#include "firmware/core/control/visual_laws.hpp"

namespace fovea::control {
namespace {

constexpr std::int64_t kEveryNs = 40 * hal::kNsPerMs;    // between requests, if they are answered
constexpr std::int64_t kLostNs = 200 * hal::kNsPerMs;    // an answer that takes longer does not come
constexpr std::int64_t kOldestNs = 300 * hal::kNsPerMs;  // of a horizon that is still followed
constexpr std::int64_t kArrivesNs = 5 * hal::kNsPerMs;   // a horizon's parts take no longer
constexpr double kMostOff = 0.05;   // a horizon that begins to be followed is at most so far off [rad, m]
constexpr double kBackGain = 10.0;  // back to the horizon [1/s]

double SecondsOf(std::int64_t ns) noexcept {
  return static_cast<double>(ns) / static_cast<double>(hal::kNsPerSecond);
}

// How far the reference is from `plan` [rad, m].
double OffOf(const trajectory::Plan& plan, const WaySight& sight) noexcept {
  trajectory::Reference at;
  plan.At(SecondsOf(sight.now_ns - plan.stamp_ns), at);
  return (at.q - sight.reference.q).lpNorm<Eigen::Infinity>();
}

void AskInTime(const WaySight& sight, bool has_answer, WayToGoal& way) noexcept {
  const std::int64_t since_ns = sight.now_ns - way.asked_ns;
  if (way.asked_ns >= 0 && since_ns < (has_answer ? kEveryNs : kLostNs)) {
    return;
  }
  if (way.asked_ns >= 0 && !has_answer && !way.planner_late) {
    way.planner_late = true;
    way.note.event = hal::PlanEvent::kLate;
  }
  Ask(sight, way);
}

// The newest horizon, in the tick in which all of it is there.
void TakeHorizon(const config::ServoConfig& config, const WaySight& sight, const trajectory::Plan& plan,
                 WayToGoal& way) noexcept {
  way.planner_late = false;
  way.note.outcome = static_cast<std::int32_t>(plan.outcome);
  const bool fits = plan.IsFound() && plan.num_joints == config.arm.num_joints &&
                    !IsElsewhere(config, sight, plan) && OffOf(plan, sight) < kMostOff;
  if (plan.IsFound() && !fits) {
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
  if (sight.has_answer && plan.stamp_ns != way.taken_ns) {
    way.taken_ns = plan.stamp_ns;
    TakeHorizon(config, sight, plan, way);
  }
  if (sight.is_seen && sight.is_told_apart && !IsMoving(config, sight)) {
    AskInTime(sight, sight.has_answer, way);
  }
  if (way.horizon_ns < 0) {
    return false;
  }
  const std::int64_t age_ns = sight.now_ns - way.horizon_ns;
  const bool is_there = plans.IsWhole() && plan.stamp_ns == way.horizon_ns;
  CountTick(!is_there, way.held_ns);
  if (age_ns > kOldestNs || way.held_ns > kArrivesNs) {
    way.horizon_ns = -1;
    return false;
  }
  trajectory::Reference at = sight.reference;
  model::VecN behind = model::VecN::Zero(at.q.size());
  if (is_there) {
    const double t = SecondsOf(age_ns);
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
