// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/goal_search.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/features/equal_turn.hpp"
#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/math.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/core/trajectory/plan_request.hpp"

namespace fovea::planning {
namespace {

constexpr double kStepMost = 0.3;     // [rad]
constexpr double kDamping = 1e-6;     // of J J^T
constexpr double kReached = 1e-10;    // [m, rad]
constexpr int kSteps = 60;            // of a descent
constexpr int kStepsLooked = 8;       // a descent ends if in this number of steps
constexpr double kComesNearer = 0.8;  // its distance has not fallen to this share
constexpr int kPasses = 3;            // of one step, to find joints at the ends of their ranges
constexpr double kNear = 0.6;         // [rad]
constexpr int kNearTrials = 8;        // from postures near the start, for each turn
constexpr int kFarTrials = 24;        // from anywhere, for each turn
constexpr double kSame = 0.2;         // goals no further apart are the same [rad]
constexpr double kAmple = 0.03;       // a posture with this much room is as good as one with more [m]
constexpr double kTightCost = 1.0;    // of a posture without room [rad]

model::Pose CameraGoal(const features::TargetFeature& feature, const model::Pose& X_BO, int turn) noexcept {
  const int turns = features::TraitsOf(feature.target).turns;
  const model::Pose turned{X_BO.R * features::EqualTurn(turn, turns), X_BO.p};
  return turned * model::Pose{feature.R_CO_star, feature.p_CO_C_star}.Inverse();
}

// How far the camera is from its goal, and the Jacobian with J dq = off. If the target's orientation is not
// seen, only its place in the camera counts.
void OffGoal(const PostureSpace& space, const Posture& posture, int turn, model::Vec6& off,
             model::Mat6N& J) noexcept {
  const features::TargetFeature& feature = space.config().feature;
  J = posture.J_C;
  if (feature.SeesOrientation()) {
    const model::Pose X_BC_star = CameraGoal(feature, space.X_BO(), turn);
    off.head<3>() = posture.X_BC.R.transpose() * (X_BC_star.p - posture.X_BC.p);
    off.tail<3>() = model::RotationVector(posture.X_BC.R.transpose() * X_BC_star.R);
  } else {
    off.head<3>() = posture.X_CO.p - feature.p_CO_C_star;
    off.tail<3>().setZero();
    J.topRows<3>() -= model::CrossMatrix(posture.X_CO.p).lazyProduct(J.bottomRows<3>());
    J.bottomRows<3>().setZero();
  }
}

// A joint at the end of its range stays there if the step would move it out.
model::VecN Step(const Range& range, const model::VecN& q, const model::Vec6& off, model::Mat6N& J) noexcept {
  model::VecN dq = model::VecN::Zero(q.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    model::Mat6 JJT = J.lazyProduct(J.transpose());
    JJT.diagonal().array() += kDamping;
    model::FactorCholesky(JJT);
    model::Vec6 x = off;
    model::SolveCholesky(JJT, x);
    dq = J.transpose().lazyProduct(x);
    const double largest = dq.lpNorm<Eigen::Infinity>();
    dq *= largest > kStepMost ? kStepMost / largest : 1.0;
    bool held = false;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      if ((q[i] >= range.most[i] && dq[i] > 0.0) || (q[i] <= range.least[i] && dq[i] < 0.0)) {
        J.col(i).setZero();
        held = true;
      }
    }
    if (!held) {
      break;
    }
  }
  return range.Clamped(q + dq);
}

// Descends from `q` to the goal. False if it gets stuck.
bool Descend(const PostureSpace& space, const model::VecN& q, int turn, Work& work,
             Posture& posture) noexcept {
  model::VecN at = space.goal_range().Clamped(q);
  double last_off = HUGE_VAL;
  for (int step = 0; step < kSteps && work.IsLeft(); ++step) {
    space.Place(at, work, posture);
    model::Vec6 off;
    model::Mat6N J;
    OffGoal(space, posture, turn, off, J);
    const double distance = off.norm();
    if (distance < kReached) {
      return true;
    }
    if (step % kStepsLooked == kStepsLooked - 1) {
      if (!(distance < kComesNearer * last_off)) {
        return false;
      }
      last_off = distance;
    }
    at = Step(space.goal_range(), at, off, J);
  }
  return false;
}

// `q` with each joint turned by whole turns to where it is nearest to `from`.
model::VecN Unwound(const PostureSpace& space, const model::VecN& from, model::VecN q) noexcept {
  constexpr double kTurn = 2.0 * model::kPi;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (space.config().arm.joints[static_cast<std::size_t>(i)].type == model::JointType::kRevolute) {
      double nearer = q[i] + kTurn * std::round((from[i] - q[i]) / kTurn);
      nearer += nearer > space.goal_range().most[i]    ? -kTurn
                : nearer < space.goal_range().least[i] ? kTurn
                                                       : 0.0;
      q[i] = nearer <= space.goal_range().most[i] && nearer >= space.goal_range().least[i] ? nearer : q[i];
    }
  }
  return q;
}

}  // namespace

bool GoalSearch::IsFor(const config::ServoConfig& config) noexcept {
  return trajectory::HasGoalPosture(config);
}

void GoalSearch::Clear() noexcept {
  goals_.clear();
  blocked_by_.fill(0);
  reached_ = 0;
}

void GoalSearch::Keep(const PostureSpace& space, const model::VecN& from, const Posture& posture, int turn,
                      double travel) noexcept {
  const double cost = space.Distance(from, posture.q) + kTightCost * std::max(1.0 - travel / kAmple, 0.0);
  const auto same = std::find_if(goals_.begin(), goals_.end(), [&](const GoalPosture& goal) {
    return (goal.q - posture.q).lpNorm<Eigen::Infinity>() < kSame;
  });
  if (same != goals_.end()) {
    if (cost >= same->cost) {
      return;
    }
    goals_.erase(same);
  } else if (goals_.size() == kMostGoals) {
    if (cost >= goals_.back().cost) {
      return;
    }
    goals_.pop_back();
  }
  const auto place = std::find_if(goals_.begin(), goals_.end(),
                                  [cost](const GoalPosture& goal) { return cost < goal.cost; });
  goals_.insert(place, GoalPosture{posture.q, turn, cost});
}

void GoalSearch::Try(const PostureSpace& space, const model::VecN& from, const model::VecN& q, int turn,
                     Work& work) noexcept {
  Posture posture;
  if (!Descend(space, q, turn, work, posture)) {
    return;
  }
  ++reached_;
  space.Place(Unwound(space, from, posture.q), work, posture);
  const PostureSpace::Verdict verdict = space.Judge(posture);
  if (!verdict.is_free) {
    ++blocked_by_[static_cast<std::size_t>(verdict.blocker)];
  } else if (!space.IsRegular(posture)) {
    ++blocked_by_[static_cast<std::size_t>(hal::Limit::kSingularity)];
  } else {
    Keep(space, from, posture, turn, verdict.travel);
  }
}

trajectory::PlanOutcome GoalSearch::Search(const PostureSpace& space, const model::VecN& q, Work& work,
                                           Draws& draws, hal::Limit& blocker) noexcept {
  const int turns = features::TraitsOf(space.config().feature.target).turns;
  const Range& range = space.goal_range();
  for (int turn = 0; turn < turns; ++turn) {
    Try(space, q, q, turn, work);
    for (int trial = 0; trial < kNearTrials; ++trial) {
      const model::VecN spread = model::VecN::Constant(q.size(), kNear);
      Try(space, q, draws.Between(q - spread, q + spread), turn, work);
    }
    for (int trial = 0; trial < kFarTrials; ++trial) {
      Try(space, q, draws.Between(range.least, range.most), turn, work);
    }
  }
  if (!goals_.empty()) {
    return trajectory::PlanOutcome::kFound;
  }
  const auto most = std::max_element(blocked_by_.begin(), blocked_by_.end());
  blocker = static_cast<hal::Limit>(most - blocked_by_.begin());
  return reached_ > 0 ? trajectory::PlanOutcome::kGoalNotClear : trajectory::PlanOutcome::kNoGoalPosture;
}

}  // namespace fovea::planning
