// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/way_to_goal.hpp"

#include <algorithm>

#include "firmware/core/control/way_in_view.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::control {
namespace {

constexpr int kStepsInATick = 4;  // of the search for a posture
constexpr int kTicksToAStep = 4;  // a posture found follows the target more slowly

// When a joint motion takes over.
constexpr double kLookS = 0.2;      // in Track, before the target's pose is trusted enough for a joint motion
constexpr double kIdleS = 0.4;      // without progress: the law is stalled
constexpr double kNearer = 0.8;     // progress: the distance falls to this share
constexpr double kIdleSureS = 1.0;  // kIdleS and kNearer for targets that the law usually reaches
constexpr double kNearerSure = 0.5;
constexpr double kThereM = 0.0015;  // the law alone reaches a goal this near
constexpr double kThereRad = 0.006;
constexpr double kMetrePerRad = 0.1;
constexpr double kBegins = 0.04;  // if a joint is further from the posture than this [rad]

// Speed and end of a joint motion.
constexpr double kGain = 3.0;       // [1/s]
constexpr double kSpeed = 1.8;      // of the fastest joint [rad/s]
constexpr double kEnds = 0.015;     // when no joint is further from the posture [rad]
constexpr double kAtDetour = 0.15;  // a waypoint this near counts as passed [rad]
constexpr double kHeldShare = 0.1;  // limits block the motion if they leave less than this share of it
constexpr double kHeldS = 0.4;      // after this time the search looks for another posture

constexpr std::int64_t kSeekNs = 1'500'000'000;  // maximum time that the arm waits for a path

bool IsLonger(std::int64_t ns, double s) noexcept {
  return static_cast<double>(ns) > s * static_cast<double>(hal::kNsPerSecond);
}

void NoteIdle(const config::ServoConfig& config, const WaySight& sight, WayToGoal& way) noexcept {
  const int turns = features::TraitsOf(config.feature.target).turns;
  const model::Mat3 R_CO = sight.X_CO.R * EqualTurn(way.goal.turn, turns);
  const bool turns_freely = !config.feature.SeesOrientation();
  const double turn =
      turns_freely ? 0.0 : model::RotationVector(config.feature.R_CO_star.transpose() * R_CO).norm();
  const double shift = (sight.X_CO.p - config.feature.p_CO_C_star).norm();
  const double off = shift + kMetrePerRad * turn;
  if (turn < kThereRad && shift < kThereM) {
    way.stalled_ns = 0;
  } else if (off < (turns_freely ? kNearerSure : kNearer) * way.least_off) {
    way.least_off = off;
    way.stalled_ns = 0;
  } else {
    CountTick((sight.limits & kBarriers) != 0, way.stalled_ns);
  }
}

void SeekOn(const config::ServoConfig& config, const WaySight& sight, WayToGoal& way) noexcept {
  const int turn = way.goal.turn;
  if (way.goal.found) {
    way.ticks_to_step = way.ticks_to_step > 0 ? way.ticks_to_step - 1 : kTicksToAStep - 1;
  } else {
    way.ticks_to_step = 0;
  }
  const int steps = way.goal.found ? 1 : kStepsInATick;
  for (int i = 0; i < steps && way.ticks_to_step == 0; ++i) {
    SeekGoalPosture(config, sight.X_BO, sight.q, way.goal);
  }
  if (way.goal.turn != turn) {
    way.least_off = HUGE_VAL;  // it belonged to another goal
  }
}

// Chooses the first way after Track began. True while the arm waits for it, kSeekNs at most.
bool StandsToChoose(const WaySight& sight, WayToGoal& way) noexcept {
  if (way.chosen || way.preferred || !sight.is_told_apart) {
    return false;  // the law's motion is needed to tell the poses apart
  }
  if (way.goal.found && !way.goal.clear && !way.goal.downhill && way.sought_ns <= kSeekNs) {
    SeekClearerPosture(way.goal);
  }
  way.chosen = way.goal.found || way.sought_ns > kSeekNs;
  way.by_joints = !way.chosen;
  return !way.chosen;
}

}  // namespace

void CountTick(bool holds, std::int64_t& ns) noexcept {
  ns = std::max<std::int64_t>(ns + (holds ? hal::kTickPeriodNs : -hal::kTickPeriodNs), 0);
}

void ChooseWay(const config::ServoConfig& config, const WaySight& sight, WayToGoal& way) noexcept {
  if (SeeksWhenIdle(config) && !way.preferred) {
    NoteIdle(config, sight, way);
    way.preferred = IsLonger(way.stalled_ns, kIdleSureS);
    return;
  }
  way.sought_ns = way.by_joints && !way.goal.found ? way.sought_ns + hal::kTickPeriodNs : 0;
  SeekOn(config, sight, way);
  if (StandsToChoose(sight, way)) {
    return;
  }
  if (way.by_joints && way.goal.found && IsLonger(way.held_ns, kHeldS)) {
    DropGoalPosture(way.goal);
    way.since_ns = sight.now_ns;
    way.held_ns = 0;
  }
  NoteIdle(config, sight, way);
  if (!way.goal.found) {
    return;
  }
  const double left = (way.goal.q - sight.q).lpNorm<Eigen::Infinity>();
  if (way.by_joints) {
    if (way.goal.detour > 0 && (way.goal.q_via - sight.q).lpNorm<Eigen::Infinity>() < kAtDetour) {
      way.goal.detour = 0;
    }
    if (left < kEnds) {
      way.by_joints = false;
      way.since_ns = sight.now_ns;
      way.stalled_ns = 0;
      way.least_off = HUGE_VAL;
    }
    return;
  }
  if (!sight.is_told_apart) {
    return;  // the pose may be the wrong one
  }
  const bool elsewhere =
      !way.preferred && !way.goal.downhill && IsLonger(sight.now_ns - sight.track_since_ns, kLookS);
  const bool idle = IsLonger(way.stalled_ns, kIdleS);
  if (idle && way.goal.downhill && !way.preferred) {
    way.preferred = true;
    SeekAnew(way.goal);  // the old posture led to this goal posture; the present one may lead to another
    return;
  }
  if (idle && way.goal.downhill && !way.goal.clear) {
    SeekClearerPosture(way.goal);  // its path is blocked: a joint motion would come no nearer than the law
    way.stalled_ns = 0;
    return;
  }
  if (elsewhere || idle) {
    way.preferred = true;
    way.held_ns = 0;
    way.stalled_ns = 0;
    if (left > kBegins) {
      way.by_joints = true;
      way.since_ns = sight.now_ns;
    }
  }
}

void SteerByJoints(const WayToGoal& way, const model::VecN& q, const features::TargetInCamera& seen,
                   const model::Mat6N& J_C, const model::Vec3& p_CO_C_star, MotionTask& task) noexcept {
  task.v.setZero(q.size());
  if (way.goal.found) {
    const model::VecN& there = way.goal.detour > 0 ? way.goal.q_via : way.goal.q;
    task.v = kGain * WayInView(there - q, seen, J_C, p_CO_C_star);
  }
  const double fastest = task.v.lpNorm<Eigen::Infinity>();
  task.v *= fastest > kSpeed ? kSpeed / fastest : 1.0;
  task.J.setIdentity(q.size(), q.size());
  task.dq_0.setZero(q.size());
  task.weight.setOnes(q.size());
}

bool NoteHeld(const MotionTask& task, const model::VecN& dq, WayToGoal& way) noexcept {
  if (!way.goal.found) {
    return way.sought_ns > kSeekNs;
  }
  const bool held = dq.dot(task.v) < kHeldShare * task.v.squaredNorm();
  CountTick(held, way.held_ns);
  return held;
}

}  // namespace fovea::control
