// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/way_to_goal.hpp"

#include <algorithm>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/control/camera_pull.hpp"
#include "firmware/core/control/count_tick.hpp"
#include "firmware/core/features/equal_turn.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"
#include "firmware/core/trajectory/plan_request.hpp"
#include "firmware/core/trajectory/smooth_step.hpp"

namespace fovea::control {
namespace {

using hal::PlanEvent;
using hal::Way;
using trajectory::Plan;

// When a plan is asked for.
constexpr double kMetrePerRad = 0.1;
constexpr double kFar = 0.12;           // from here on a plan is worth a stop [m]
constexpr double kNear = 0.03;          // after a goal that was this near, a far one is a new one
constexpr double kMovingTarget = 0.05;  // a faster target is followed by the law [m/s]
constexpr double kIdleS = 0.4;          // without progress: the law is stalled,
constexpr double kIdleLateS = 2.0;      // and asks again although the last plan has not come
constexpr double kNearer = 0.8;         // progress: the distance falls to this share
constexpr double kThereM = 0.0015;      // the law alone reaches a goal this near
constexpr double kThereRad = 0.006;
constexpr int kTriesOfSure = 2;                       // count more if the planner knows of no posture
constexpr int kMostTries = 6;                         // for the same goal
constexpr double kCareful = 0.25;                     // pace of the law while it tells poses apart,
constexpr double kCarefulS = 1.5;                     // for so long at most
constexpr double kSlowingS = 0.4;                     // from the law's full pace to rest
constexpr double kSlow = 0.1;                         // a joint this slow is stopped at once [rad/s, m/s]
constexpr double kWaitS = 2.0;                        // for a plan
constexpr double kWaitLateS = 0.1;                    // if the last one did not come in time
constexpr std::int64_t kAgainNs = hal::kNsPerSecond;  // between new plans because the target moved

// When a plan is followed.
constexpr double kSameStart = 1e-9;   // [rad]
constexpr double kElsewhereM = 0.08;  // a target this far from where it was planned for
constexpr double kElsewhereRad = 0.25;
constexpr double kSamePlaceM = 0.2;    // as near as this, the plan's end is a posture to keep
constexpr double kShiftMost = 0.3;     // of the plan's end [rad]
constexpr double kShiftS = 0.05;       // time constant with which the end follows the estimate
constexpr double kTrustS = 0.1;        // until a sound eye is trusted, and until one that sees nothing is not
constexpr double kTrustAnywayS = 1.5;  // until one is that had nothing to show
constexpr double kFirstPace = 0.5;     // without trust
constexpr double kGain = 10.0;         // back to the plan [1/s]
constexpr double kBehind = 0.02;       // the plan slows down if the reference is so far off it [rad]
constexpr double kHeldS = 0.4;

bool IsLonger(std::int64_t ns, double s) noexcept {
  return static_cast<double>(ns) > s * static_cast<double>(hal::kNsPerSecond);
}

// The pace of a plan that the target's sight does not hold up.
double PaceOf(double trust) noexcept { return kFirstPace + (1.0 - kFirstPace) * trust; }

struct Off {
  double shift;  // [m]
  double turn;   // [rad]; 0 if the feature leaves it free
  [[nodiscard]] double Both() const noexcept { return shift + kMetrePerRad * turn; }
};

Off OffGoal(const config::ServoConfig& config, const WaySight& sight, int turn) noexcept {
  Off off{(sight.X_CO.p - config.feature.p_CO_C_star).norm(), 0.0};
  if (config.feature.SeesOrientation()) {
    const int turns = features::TraitsOf(config.feature.target).turns;
    const model::Mat3 R_CO = sight.X_CO.R * features::EqualTurn(turn, turns);
    off.turn = model::RotationVector(config.feature.R_CO_star.transpose() * R_CO).norm();
  }
  return off;
}

// A moving target is left to the law. One that leaves its plans again and again gets a new one at a bounded
// rate.
bool MayPlanFor(const config::ServoConfig& config, const WaySight& sight, const WayToGoal& way) noexcept {
  return !IsMoving(config, sight) && sight.now_ns >= way.again_ns;
}

void NoteIdle(const WaySight& sight, const Off& off, WayToGoal& way) noexcept {
  way.is_there = off.turn < kThereRad && off.shift < kThereM;
  if (way.is_there) {
    way.stalled_ns = 0;
    way.note.tries = 0;
  } else if (off.Both() < kNearer * way.least_off) {
    way.least_off = off.Both();
    way.stalled_ns = 0;
  } else {
    CountTick((sight.limits & kBarriers) != 0, way.stalled_ns);
  }
}

void Change(Way to, PlanEvent event, std::int64_t now_ns, WayToGoal& way) noexcept {
  way.note.way = to;
  way.note.event = event;
  way.since_ns = now_ns;
  way.asked_ns = -1;
  way.horizon_ns = -1;
  way.stalled_ns = 0;
  way.held_ns = 0;
  way.least_off = HUGE_VAL;
  way.pace = to == Way::kAwaitPlan ? way.pace : 1.0;
}

void GoOnByLaw(const config::ServoConfig& config, const WaySight& sight, WayToGoal& way) noexcept {
  way.since_ns = way.since_ns == 0 ? sight.now_ns : way.since_ns;
  if (!way.turn_known || (!sight.is_told_apart && !way.keeps_posture)) {
    way.turn = features::NearestTurn(config.feature, sight.X_CO.R);
    way.turn_known = true;
  }
  if (!config.law.plans) {
    return;
  }
  const Off off = OffGoal(config, sight, way.turn);
  NoteIdle(sight, off, way);
  way.is_fresh = way.is_fresh || off.Both() < kNear;
  way.is_new_goal = way.is_new_goal || off.Both() < kNear;
  const bool far = way.is_fresh && off.Both() > kFar && MayPlanFor(config, sight, way);
  const bool may_plan = way.note.tries < kMostTries;
  // While several poses fit, the law's motion has to tell them apart. It may end soon, so it is slow.
  const bool is_careful =
      may_plan && far && !sight.is_told_apart && !IsLonger(sight.now_ns - way.since_ns, kCarefulS);
  way.pace = is_careful ? kCareful : std::min(way.pace + hal::kTickPeriodS / kSlowingS, 1.0);
  // If limits stop the law, a plan's motion has to tell the poses apart.
  const double idle_s = way.IsPlannerLate() ? kIdleLateS : kIdleS;
  if (may_plan && ((far && sight.is_told_apart) || IsLonger(way.stalled_ns, idle_s))) {
    if (far && way.is_new_goal) {
      way.note.tries = 0;
    } else if (far) {
      way.again_ns = sight.now_ns + kAgainNs;
    }
    way.is_new_goal = false;
    Change(Way::kAwaitPlan, PlanEvent::kNone, sight.now_ns, way);
  }
}

model::Vec3 PlaceOf(const Plan& plan) noexcept { return {plan.p_BO[0], plan.p_BO[1], plan.p_BO[2]}; }

// The twist that takes the camera from the plan's goal to the present one, in axes of the camera there.
model::Vec6 GoalTwist(const config::ServoConfig& config, const WaySight& sight, const Plan& plan,
                      const model::Pose& X_BC_end) noexcept {
  const model::Vec3 p_BO = PlaceOf(plan);
  model::Vec3 turn_B = model::Vec3::Zero();
  model::Mat3 R_BO;
  if (config.feature.SeesOrientation() && model::RotationOfQuaternion(plan.q_BO, R_BO)) {
    turn_B = model::RotationVector(sight.X_BO.R * R_BO.transpose());
  }
  model::Vec6 twist;
  twist.head<3>() = X_BC_end.R.transpose() *
                    (sight.X_BO.p - p_BO + model::CrossMatrix(turn_B).lazyProduct(X_BC_end.p - p_BO));
  twist.tail<3>() = X_BC_end.R.transpose() * turn_B;
  return twist;
}

// Takes a plan for this start: from its end on, the joints follow the estimate.
void Take(const config::ServoConfig& config, const Plan& plan, const WaySight& sight,
          WayToGoal& way) noexcept {
  Change(Way::kPlan, PlanEvent::kTaken, sight.now_ns, way);
  trajectory::Reference end;
  plan.At(plan.Duration(), end);
  way.q_end = end.q;
  way.t = 0.0;
  way.turn = plan.turn;
  way.keeps_posture = true;
  way.p_BO_end = PlaceOf(plan);
  way.shift.setZero(end.q.size());
  model::ArmPoses poses;
  model::ComputePoses(config.arm, end.q, poses);
  way.X_BC_end = poses.X_BE * config.X_EC;
  model::Mat6N J_C;
  model::ComputeJacobian(config.arm, poses, config.X_EC, J_C);
  way.pull = CameraPull(J_C);
}

void AwaitPlan(const config::ServoConfig& config, const WaySight& sight, const Plan& plan,
               WayToGoal& way) noexcept {
  if (way.asked_ns < 0) {
    way.pace = std::max(way.pace - hal::kTickPeriodS / kSlowingS, 0.0);
    if (sight.reference.IsAtRest()) {
      way.is_fresh = false;
      ++way.note.tries;
      way.note.event = PlanEvent::kAsked;
      Ask(sight, way);
    }
    return;
  }
  if (!sight.has_answer) {
    if (IsLonger(sight.now_ns - way.asked_ns, way.IsPlannerLate() ? kWaitLateS : kWaitS)) {
      way.late_ns = way.asked_ns;
      --way.note.tries;  // nobody has tried
      Change(Way::kLaw, PlanEvent::kLate, sight.now_ns, way);
    }
    return;
  }
  way.late_ns = -1;
  way.note.outcome = static_cast<std::int32_t>(plan.outcome);
  if (!plan.IsFound()) {
    const bool is_sure = plan.outcome == trajectory::PlanOutcome::kNoGoalPosture ||
                         plan.outcome == trajectory::PlanOutcome::kGoalNotClear;
    way.note.tries += is_sure ? kTriesOfSure : 0;
    Change(Way::kLaw, PlanEvent::kNoMotion, sight.now_ns, way);
    return;
  }
  trajectory::Reference start;
  plan.At(0.0, start);
  const bool fits = plan.num_joints == config.arm.num_joints &&
                    (start.q - sight.reference.q).lpNorm<Eigen::Infinity>() < kSameStart;
  if (!fits || IsElsewhere(config, sight, plan)) {
    Change(Way::kLaw, PlanEvent::kStale, sight.now_ns, way);
    way.is_fresh = true;
    return;
  }
  Take(config, plan, sight, way);
}

// After a plan that did not lead to the goal.
Way NextWay(const WayToGoal& way) noexcept {
  return way.note.tries < kMostTries ? Way::kAwaitPlan : Way::kLaw;
}

// How fast the plan's pace may grow without more acceleration than a joint has [1/s].
double MostPaceRate(const config::ServoConfig& config, const Plan& plan, const WayToGoal& way) noexcept {
  trajectory::Reference at;
  plan.At(way.t, at);
  const double pace = PaceOf(way.trust);
  double most = HUGE_VAL;
  for (int i = 0; i < at.q.size(); ++i) {
    const double left = trajectory::PaceOf(config, i).ddq_max - pace * pace * std::fabs(at.ddq[i]);
    most = std::min(most, std::max(left, 0.0) / std::max(std::fabs(at.dq[i]), 1e-9));
  }
  return most;
}

void GoOnByPlan(const config::ServoConfig& config, const WaySight& sight, const Plan& plan,
                WayToGoal& way) noexcept {
  if (way.t >= plan.Duration()) {
    Change(Way::kLaw, PlanEvent::kDone, sight.now_ns, way);
    return;
  }
  const model::Vec6 twist = GoalTwist(config, sight, plan, way.X_BC_end);
  const model::VecN shift = way.pull.transpose().lazyProduct(twist);
  if (IsElsewhere(config, sight, plan) || !(shift.lpNorm<Eigen::Infinity>() < kShiftMost)) {
    const bool at_once = MayPlanFor(config, sight, way);
    Change(at_once ? NextWay(way) : Way::kLaw, PlanEvent::kTargetMoved, sight.now_ns, way);
    way.is_fresh = true;
    way.again_ns = at_once ? sight.now_ns + kAgainNs : way.again_ns;
    return;
  }
  const double trust_s = !sight.is_seen || sight.is_eye_suspected ? -kTrustS
                         : sight.is_eye_trusted                   ? kTrustS
                                                                  : kTrustAnywayS;
  double rate = 1.0 / trust_s;
  if (rate > 0.0 && way.trust < 1.0) {
    rate = std::min(rate, MostPaceRate(config, plan, way) / (1.0 - kFirstPace));
  }
  way.trust = std::clamp(way.trust + hal::kTickPeriodS * rate, 0.0, 1.0);
  way.shift += (hal::kTickPeriodS / kShiftS) * (shift - way.shift);
  if (IsLonger(way.held_ns, kHeldS)) {
    Change(NextWay(way), PlanEvent::kHeld, sight.now_ns, way);
  }
}

// The velocity that takes joints back to a plan from which they are `behind`: no faster than they can stop
// there.
model::VecN BackToPlan(const config::ServoConfig& config, const model::VecN& behind) noexcept {
  model::VecN v = kGain * behind;
  for (int i = 0; i < v.size(); ++i) {
    const trajectory::JointPace pace = trajectory::PaceOf(config, i);
    const double most = barriers::BarrierSpeed(std::fabs(behind[i]), pace.deceleration, pace.reaction_s);
    v[i] = std::clamp(v[i], -most, most);
  }
  return v;
}

}  // namespace

bool IsMoving(const config::ServoConfig& config, const WaySight& sight) noexcept {
  const double turn = config.feature.SeesOrientation() ? kMetrePerRad * sight.w_BO.norm() : 0.0;
  return sight.v_BO.norm() + turn > kMovingTarget;
}

bool IsSamePlace(const model::Pose& a, const model::Pose& b) noexcept {
  return (a.p - b.p).norm() < kElsewhereM &&
         model::RotationVector(a.R * b.R.transpose()).norm() < kElsewhereRad;
}

bool IsElsewhere(const config::ServoConfig& config, const WaySight& sight, const Plan& plan) noexcept {
  const double turn = GoalTwist(config, sight, plan, model::Pose{}).tail<3>().norm();
  return !((sight.X_BO.p - PlaceOf(plan)).norm() < kElsewhereM) || !(turn < kElsewhereRad);
}

void Ask(const WaySight& sight, WayToGoal& way) noexcept {
  way.asked_ns = sight.now_ns;
  ++way.note.plans_asked;
  for (Eigen::Index i = 0; i < 3; ++i) {
    way.note.normal_B[static_cast<std::size_t>(i)] = sight.normal_B[i];
  }
}

void WayToGoal::Restart() noexcept {
  const hal::WayNote before = note;
  const std::int64_t late = late_ns;
  *this = WayToGoal{};
  note.plans_asked = before.plans_asked;
  note.outcome = before.outcome;
  late_ns = late;
}

void ChooseWay(const config::ServoConfig& config, const WaySight& sight, const Plan& plan,
               WayToGoal& way) noexcept {
  way.note.event = PlanEvent::kNone;
  switch (way.note.way) {
    case Way::kLaw: GoOnByLaw(config, sight, way); return;
    case Way::kAwaitPlan: AwaitPlan(config, sight, plan, way); return;
    case Way::kPlan: GoOnByPlan(config, sight, plan, way); return;
  }
}

void FollowPlan(const config::ServoConfig& config, const Plan& plan, const trajectory::Reference& reference,
                bool is_seen, WayToGoal& way, PlanStep& step) noexcept {
  trajectory::Reference at;
  plan.At(way.t, at);
  const double share = trajectory::SmoothStep(way.t / plan.Duration());
  const model::VecN behind = at.q + share * way.shift - reference.q;
  const double keeps_up = std::clamp(2.0 - behind.lpNorm<Eigen::Infinity>() / kBehind, 0.0, 1.0);
  CountTick(keeps_up < 0.5, way.held_ns);
  const double pace = keeps_up * (is_seen ? PaceOf(way.trust) : way.trust);
  way.t += pace * hal::kTickPeriodS;
  plan.At(way.t, at);
  const double growth = (trajectory::SmoothStep(way.t / plan.Duration()) - share) / hal::kTickPeriodS;
  step.task.v = pace * at.dq + growth * way.shift + BackToPlan(config, behind);
  step.task.J.setIdentity(at.q.size(), at.q.size());
  step.task.dq_0.setZero(at.q.size());
  step.task.weight.setOnes(at.q.size());
  step.ddq = pace * at.ddq;
}

double SlowingPace(const WayToGoal& way, const trajectory::Reference& reference) noexcept {
  const bool slows = way.note.way == hal::Way::kAwaitPlan && way.asked_ns < 0 &&
                     reference.dq.lpNorm<Eigen::Infinity>() >= kSlow;
  return slows ? way.pace : 0.0;
}

bool KeepsPosture(const WayToGoal& way, const model::Vec3& p_BO) noexcept {
  return way.keeps_posture && (p_BO - way.p_BO_end).norm() < kSamePlaceM;
}

bool IsHeldUp(const WayToGoal& way) noexcept { return way.note.way == hal::Way::kPlan && way.held_ns > 0; }

bool HasNoWay(const config::LawConfig& config, const WayToGoal& way) noexcept {
  return way.note.way == hal::Way::kLaw && (way.note.tries >= kMostTries || way.IsPlannerLate()) &&
         IsLonger(way.stalled_ns, config.unreachable_s);
}

bool MayFindAWay(const config::ServoConfig& config, const WayToGoal& way) noexcept {
  if (!trajectory::IsPlannable(config)) {
    return false;
  }
  const bool may_ask = way.note.tries < kMostTries && !way.is_there && !way.IsPlannerLate();
  return way.note.way != Way::kLaw || may_ask;
}

}  // namespace fovea::control
