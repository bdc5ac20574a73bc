// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/core/model/rotation.hpp"
#include "firmware/planning/goal_search.hpp"
#include "firmware/planning/horizon_search.hpp"
#include "firmware/planning/motion_proof.hpp"
#include "firmware/planning/path_search.hpp"
#include "firmware/planning/path_speed.hpp"
#include "firmware/planning/posture_space.hpp"
#include "firmware/planning/shorten_path.hpp"
#include "firmware/planning/smooth_path.hpp"
#include "firmware/planning/time_path.hpp"

namespace fovea::planning {
namespace {

using trajectory::Plan;
using trajectory::PlanHead;
using trajectory::PlanOutcome;
using trajectory::PlanRequest;

constexpr double kGoalShare = 0.2;  // of the budget, after which a search for goals that found none ends
// A search that is unlucky starts anew, with more goals: so long for the first one, and so much longer each
// time.
constexpr double kFirstSlice = 6000.0;
constexpr double kMoreEachRound = 1.5;
// A search that found no way keeps less room before lines of sight and steep views after this share of the
// budget, or this much work.
constexpr double kStrictShare = 0.5;
constexpr double kStrictWork = 80'000.0;
// Beyond this work, which no first search of the servo has, it shows a target from very steep sides.
constexpr double kWideWork = 240'000.0;
// For making a path shorter: the larger of these.
constexpr double kShortenWork = 4000.0;
constexpr double kShortenWorkOfRad = 1000.0;
// If the path is this much longer than straight to the nearest goal, the search goes on for a quicker motion,
// for this much work for each second of the motion found: a twentieth of that time with 2.5 us for a posture.
constexpr double kRoundabout = 1.25;
constexpr double kWorkOfSecond = 20'000.0;
constexpr int kMostMotions = 24;
constexpr double kSpacing = 0.1;  // of control points [rad]
constexpr int kLeastPoints = 5;
constexpr int kMostPoints = 256;
// For a path that is not straightened: few points round its corners off, many keep to it.
constexpr std::array<int, 2> kAsItIs{64, kMostPoints};
constexpr int kSweeps = 12;    // of straightening
constexpr int kSlowings = 10;  // of a motion that the guard would slow down
constexpr double kSlower = 0.75;

double Spent(const PlanRequest& request, const Work& work) noexcept {
  return static_cast<double>(request.budget + Planner::kProofWork - work.left());
}

bool IsOffWhole(const PlanRequest& request) noexcept {
  return request.kind == PlanRequest::Kind::kPlan ||
         (request.q_off.size() == request.start.q.size() && request.q_off.allFinite());
}

bool IsWhole(const config::ServoConfig& config, const PlanRequest& request) noexcept {
  const trajectory::Reference& start = request.start;
  const Eigen::Index n = config.arm.num_joints;
  return start.q.size() == n && start.dq.size() == n && start.ddq.size() == n && start.q.allFinite() &&
         start.dq.allFinite() && start.ddq.allFinite() && request.v_BO.allFinite() && IsOffWhole(request) &&
         request.X_BO.R.allFinite() && request.X_BO.p.allFinite() && request.normal_B.allFinite();
}

}  // namespace

struct Planner::Parts {
  Parts(const config::ServoConfig& servo, const EyeReach& reach)
      : config(servo),
        space(servo, reach),
        limits(LimitsOfPlan(servo)),
        horizon(servo),
        speed(limits, kMostPoints) {
    path.reserve(kMostCorners);
    corners.reserve(kMostCorners);
  }

  PlanOutcome Search(const PlanRequest& request, Work& work, Draws& draws, Plan& plan) noexcept;
  bool FindPath(const model::VecN& start, bool straight, std::int64_t slice, Work& work, Draws& draws,
                std::int32_t& turn) noexcept;
  [[nodiscard]] bool IsRoundabout(const model::VecN& start) const noexcept;
  bool Smooth(Work& work, Plan& plan) noexcept;
  bool Time(Work& work, Plan& plan) noexcept;

  const config::ServoConfig& config;
  PostureSpace space;
  JointLimits limits;
  GoalSearch goals;
  HorizonSearch horizon;
  PathSearch search;
  PathShortener shortener;
  PathSpeed speed;
  Polyline path;     // found, and made short
  Polyline corners;  // of the smooth path
  Plan found;        // along it
  Effort effort;
};

// Finds a path and makes it short. `straight`: tries the straight ones first.
bool Planner::Parts::FindPath(const model::VecN& start, bool straight, std::int64_t slice, Work& work,
                              Draws& draws, std::int32_t& turn) noexcept {
  const std::vector<GoalPosture>& to = goals.goals();
  int goal = 0;
  Work round = work.Part(slice);
  const bool is_found = (straight && search.FindStraight(space, start, to, round, path, goal)) ||
                        search.FindByTrees(space, start, to, round, draws, path, goal);
  work.Join(round);
  if (is_found) {
    const double most = std::max(kShortenWork, kShortenWorkOfRad * LengthOf(space, path));
    shortener.Shorten(space, static_cast<int>(most), work, draws, path);
    turn = to[static_cast<std::size_t>(goal)].turn;
  }
  return is_found;
}

bool Planner::Parts::IsRoundabout(const model::VecN& start) const noexcept {
  double nearest = HUGE_VAL;
  for (const GoalPosture& goal : goals.goals()) {
    nearest = std::min(nearest, space.Distance(start, goal.q));
  }
  return LengthOf(space, path) > kRoundabout * nearest;
}

// Makes a plan along the path that was found: straightened, or if that cuts an edge, as it is.
bool Planner::Parts::Smooth(Work& work, Plan& plan) noexcept {
  const double length = LengthOf(space, path);
  corners.assign(path.begin(), path.end());
  shortener.Resample(space, std::clamp(1 + static_cast<int>(length / kSpacing), kLeastPoints, kMostPoints),
                     corners);
  Straighten(space, kSweeps, work, corners);
  if (Time(work, plan)) {
    return true;
  }
  return std::any_of(kAsItIs.begin(), kAsItIs.end(), [&](int points) {
    corners.assign(path.begin(), path.end());
    shortener.Resample(space, points, corners);
    return Time(work, plan);
  });
}

// Times `corners` into the plan and proves it.
bool Planner::Parts::Time(Work& work, Plan& plan) noexcept {
  const SmoothPath smooth(corners);
  speed.Begin(space, smooth, work);
  for (int slowing = 0; slowing < kSlowings && work.IsLeft(); ++slowing) {
    const double duration = speed.Run();
    if (!(duration < Plan::kMostDuration)) {
      return false;
    }
    TimePath(smooth, speed, duration, limits, plan);
    const double lag = LagOf(limits, plan.num_joints, plan.period_s);
    guard::KnownClearances known;
    bool passes = true;
    std::size_t cell = 0;
    double t = 0.0;
    while (t < plan.Duration() && work.IsLeft()) {
      if (!IsLetPass(space, plan, t, known, work)) {
        passes = false;
        speed.SlowDown(speed.UAt(t - lag, cell), kSlower);
      }
      t += kGuardStep;
    }
    if (passes && work.IsLeft()) {
      return FirstBlocked(space, plan, work) < 0.0;
    }
  }
  return false;
}

// Keeps the quickest motion found.
PlanOutcome Planner::Parts::Search(const PlanRequest& request, Work& work, Draws& draws,
                                   Plan& plan) noexcept {
  PlanOutcome outcome = PlanOutcome::kNoPath;
  goals.Clear();
  auto slice = kFirstSlice;
  double least = HUGE_VAL;  // duration [s]
  int motions = 0;
  bool seek_goals = true;
  const auto is_enough = [&] {
    return work.left() <= Planner::kProofWork || motions >= kMostMotions ||
           Spent(request, work) > kWorkOfSecond * least;
  };
  while (!is_enough()) {
    if (seek_goals) {
      const PlanOutcome found_goals = goals.Search(space, request.start.q, work, draws, plan.blocker);
      effort.goals = static_cast<int>(goals.goals().size());
      if (found_goals != PlanOutcome::kFound) {
        outcome = found_goals;
        if (space.AllowTightGoals()) {
          continue;  // a goal beside a bound is better than none
        }
        if (Spent(request, work) > kGoalShare * static_cast<double>(request.budget)) {
          return outcome;
        }
        continue;
      }
    }
    static_cast<PlanHead&>(found) = plan;
    seek_goals = true;
    const std::int64_t most =
        std::clamp<std::int64_t>(work.left() - Planner::kProofWork, 0, static_cast<std::int64_t>(slice));
    if (!FindPath(request.start.q, motions == 0, most, work, draws, found.turn)) {
      outcome = outcome == PlanOutcome::kNotProved ? outcome : PlanOutcome::kNoPath;
      slice *= kMoreEachRound;
      if (Spent(request, work) > std::min(kStrictShare * static_cast<double>(request.budget), kStrictWork)) {
        space.AllowNarrowPassages();  // better than none
      }
      if (Spent(request, work) > kWideWork) {
        space.AllowSteepViews();
      }
      continue;
    }
    const bool is_roundabout = IsRoundabout(request.start.q);
    const double length = LengthOf(space, path);
    if (!Smooth(work, found)) {
      outcome = outcome == PlanOutcome::kFound ? outcome : PlanOutcome::kNotProved;
      slice *= kMoreEachRound;
      continue;
    }
    ++motions;
    seek_goals = false;
    if (found.Duration() < least) {
      outcome = PlanOutcome::kFound;
      least = found.Duration();
      effort.length = length;
      plan = found;
    }
    if (!is_roundabout) {
      break;
    }
  }
  return least < HUGE_VAL ? PlanOutcome::kFound : outcome;
}

Planner::Planner(const config::ServoConfig& config, const EyeReach& reach)
    : parts_(std::make_unique<Parts>(config, reach)) {}
Planner::~Planner() = default;

void Planner::Compute(const PlanRequest& request, Plan& plan) noexcept {
  Parts& parts = *parts_;
  parts.effort = {};
  plan = Plan{};
  plan.stamp_ns = request.stamp_ns;
  plan.num_joints = parts.config.arm.num_joints;
  if (!IsWhole(parts.config, request)) {
    plan.outcome = PlanOutcome::kBadRequest;
    return;
  }
  if (!GoalSearch::IsFor(parts.config)) {
    plan.outcome = PlanOutcome::kNotPlanned;
    return;
  }
  const bool is_horizon = request.kind == PlanRequest::Kind::kHorizon;
  if (!is_horizon && !request.start.IsAtRest()) {
    plan.outcome = PlanOutcome::kStartMoves;
    return;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    plan.p_BO[i] = request.X_BO.p[static_cast<Eigen::Index>(i)];
  }
  plan.q_BO = model::QuaternionOf(request.X_BO.R);
  const std::int64_t most = is_horizon ? request.budget : request.budget + kProofWork;
  Work work(most);
  if (is_horizon) {
    plan.outcome = parts.horizon.Search(request, work, plan);
  } else if (plan.outcome = parts.space.Begin(request, plan.blocker); plan.outcome == PlanOutcome::kFound) {
    Draws draws(request.seed);
    plan.outcome = parts.Search(request, work, draws, plan);
  }
  parts.effort.work = most - work.left();
  if (!plan.IsFound()) {
    plan.num_points = 0;
    plan.period_s = 0.0;
  }
  std::fill(plan.points.begin() + plan.NumNumbers(), plan.points.end(), 0.0);
}

const Planner::Effort& Planner::effort() const noexcept { return parts_->effort; }

}  // namespace fovea::planning
