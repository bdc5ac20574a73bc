// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/horizon_search.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/barriers/field_of_view_barrier.hpp"
#include "firmware/core/control/goal_size.hpp"
#include "firmware/core/control/visual_law.hpp"
#include "firmware/core/features/equal_turn.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/planning/time_path.hpp"

namespace fovea::planning {
namespace {

using trajectory::PlanOutcome;

constexpr int kControlPoints = 21;  // control points
constexpr int kFixed = 3;           // of them, at the start
constexpr int kFree = kControlPoints - kFixed - 2;
constexpr int kKnots = kControlPoints - 2;  // from the start to the end, both included
constexpr double kKnotPeriod = 0.05;        // about the time until the next horizon is there [s]
constexpr int kNewtonSteps = 4;             // of Gauss and Newton
constexpr int kStepHalvings = 3;            // of a step that makes it worse
constexpr double kLongestStep = 0.3;        // of a step [rad, m]
constexpr double kSlowJoint = 0.02;         // the lag of slower joints is not known [rad/s, m/s]
constexpr double kLagMost = 0.1;            // of the arm behind its reference [s]
// Weights beside the features' squared errors.
constexpr double kOfFree = 0.01;            // of the velocities that the feature leaves free [s^2]
constexpr double kFreeBelow = 1e-6;         // squared singular values of de/dq that leave a direction free
constexpr double kOfAcceleration = 1e-5;    // [s^4]
constexpr double kLeastGain = 0.01;         // [1/s]
constexpr double kPenaltyOfMotion = 100.0;  // of the joints' limits, beside 1 of barriers
constexpr double kReturn = 0.1;             // of a barrier that is past its margin, per second
constexpr double kNearSolid = 0.15;         // a barrier farther away has no row [m]
constexpr int kWorkOfKnot = 4;              // postures that a linearised knot counts for
constexpr int kWorkOfProgram = 200;         // a quadratic program
constexpr int kRowsOfKnot = 4 + barriers::SolidBarriers::kMost;

// Shares of the control points `knot`, `knot` + 1, `knot` + 2 in the joints at a knot.
constexpr std::array<double, 3> kShares{1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};

// The number of the free control point that point `i` is, i >= kFixed: the last three are one.
constexpr int FreeOf(int i) noexcept { return std::min(i - kFixed, kFree - 1); }

}  // namespace

HorizonSearch::HorizonSearch(const config::ServoConfig& config)
    : config_(config),
      num_joints_(config.arm.num_joints),
      limits_(LimitsOfPlan(config)),
      solid_(config),
      outline_(config.feature.Outline()),
      program_(kFree * num_joints_, 4 * kControlPoints * num_joints_ + kKnots * kRowsOfKnot),
      c_(kFree * num_joints_),
      trial_(kFree * num_joints_) {}

model::VecN HorizonSearch::Point(const Eigen::VectorXd& c, int i) const noexcept {
  return i < kFixed ? first_[static_cast<std::size_t>(i)]
                    : model::VecN(c.segment(FreeOf(i) * num_joints_, num_joints_));
}

model::VecN HorizonSearch::Sum(const Eigen::VectorXd& c, int knot,
                               const std::array<double, 3>& share) const noexcept {
  model::VecN sum = model::VecN::Zero(num_joints_);
  for (int i = 0; i < 3; ++i) {
    sum += share[static_cast<std::size_t>(i)] * Point(c, knot + i);
  }
  return sum;
}

std::array<double, 3> HorizonSearch::PlaceShares() const noexcept {
  const double before = lag_s_ * 0.5 / kKnotPeriod;
  return {kShares[0] + before, kShares[1], kShares[2] - before};
}

model::VecN HorizonSearch::At(const Eigen::VectorXd& c, int knot) const noexcept {
  return Sum(c, knot, kShares);
}

std::array<HorizonSearch::Form, 2> HorizonSearch::FormsAt(const Eigen::VectorXd& c, int knot,
                                                          const Knot& seen) const noexcept {
  const double half = 0.5 / kKnotPeriod;
  const double of_rate = 1.0 / (gain_ * gain_);
  // The last knot stands for all that follow: the sum over an error that goes on decaying.
  const double of_place = knot == kKnots - 1 ? std::max(1.0 / (gain_ * kKnotPeriod), 1.0) : 1.0;
  std::array<Form, 2> forms;
  Form& place = forms[0];
  place.share = PlaceShares();
  place.value = of_place * seen.e.squaredNorm();
  place.g = of_place * (seen.J.transpose() * seen.e);
  place.G = of_place * (seen.J.transpose() * seen.J);
  Form& motion = forms[1];
  motion.share = {-half, 0.0, half};
  const model::VecN dq = Sum(c, knot, motion.share);
  const features::FeatureVector rate = seen.J * dq + seen.drift;
  motion.G = of_rate * (seen.J.transpose() * seen.J) + kOfFree * seen.N;
  motion.g = of_rate * (seen.J.transpose() * rate) + kOfFree * (seen.N * dq);
  motion.value = of_rate * rate.squaredNorm() + kOfFree * dq.dot(seen.N * dq);
  return forms;
}

features::TargetInCamera HorizonSearch::TargetAt(const model::Pose& X_BC, int knot) const noexcept {
  const model::Pose X_BO{X_BO_.R, X_BO_.p + knot * kKnotPeriod * v_BO_};
  return {X_BC.Inverse() * X_BO, X_BC.R.transpose() * v_BO_};
}

bool HorizonSearch::See(const model::VecN& q, int knot, Knot& seen) const noexcept {
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, q + q_off_, poses);
  model::Mat6N J_C;
  model::ComputeJacobian(config_.arm, poses, config_.X_EC, J_C);
  features::FeatureState feature;
  if (!config_.feature.Compute(TargetAt(poses.X_BE * config_.X_EC, knot), feature)) {
    return false;
  }
  seen.size = control::GoalSize(feature);
  seen.e = (feature.s - feature.s_star) / seen.size;
  seen.drift = feature.ds_dt_target / seen.size;
  seen.J = feature.L_s * J_C / seen.size;
  model::MatN A = seen.J.transpose() * seen.J;
  A.diagonal().array() += kFreeBelow;
  seen.N = kFreeBelow * A.llt().solve(model::MatN::Identity(num_joints_, num_joints_));
  return true;
}

// The motion goes on with the start's velocity for a period, and stands then.
void HorizonSearch::Begin(const trajectory::PlanRequest& request) noexcept {
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, request.start.q + request.q_off, poses);
  const model::Pose X_CB = (poses.X_BE * config_.X_EC).Inverse();
  turn_ = features::NearestTurn(config_.feature, X_CB.R * request.X_BO.R);
  const int turns = features::TraitsOf(config_.feature.target).turns;
  X_BO_ = {request.X_BO.R * features::EqualTurn(turn_, turns), request.X_BO.p};
  v_BO_ = request.v_BO;
  // The joints are where the reference was a lag ago, and off by what does not end with the motion.
  const model::VecN& dq = request.start.dq;
  lag_s_ = std::clamp(-request.q_off.dot(dq) / (dq.squaredNorm() + kSlowJoint * kSlowJoint), 0.0, kLagMost);
  q_off_ = request.q_off + lag_s_ * dq;
  const double T = kKnotPeriod;
  const model::VecN step = T * request.start.dq;
  const model::VecN bend = T * T * request.start.ddq;
  first_[1] = request.start.q - bend / 6.0;
  first_[0] = first_[1] - step + 0.5 * bend;
  first_[2] = first_[1] + step + 0.5 * bend;
  for (int i = 0; i < kFree; ++i) {
    c_.segment(i * num_joints_, num_joints_) = first_[2];
  }
  Knot seen;
  const double off = See(Sum(c_, 0, PlaceShares()), 0, seen) ? seen.size * seen.e.norm() : HUGE_VAL;
  gain_ = std::max(control::GainAt(config_.law, off), kLeastGain);
}

double HorizonSearch::Cost(const Eigen::VectorXd& c, Work& work) noexcept {
  double cost = 0.0;
  Knot seen;
  for (int knot = 1; knot < kKnots; ++knot) {
    work.Spend();
    if (!See(Sum(c, knot, PlaceShares()), knot, seen)) {
      return HUGE_VAL;
    }
    for (const Form& form : FormsAt(c, knot, seen)) {
      cost += form.value;
    }
  }
  for (int i = 1; i + 2 < kControlPoints; ++i) {
    const model::VecN bend =
        (Point(c, i + 2) - 2.0 * Point(c, i + 1) + Point(c, i)) / (kKnotPeriod * kKnotPeriod);
    cost += kOfAcceleration * bend.squaredNorm();
  }
  return cost;
}

// Costs and rows of the control points themselves, joint by joint.
void HorizonSearch::AddMotion(const Eigen::VectorXd& c) noexcept {
  using Row = HorizonProgram::Row;
  struct Difference {
    int size;
    std::array<double, 4> share;
    double weight;
  };
  constexpr double T = kKnotPeriod;
  constexpr std::array<Difference, 3> kDifferences{{{2, {-1.0, 1.0}, 0.0},
                                                    {3, {1.0, -2.0, 1.0}, kOfAcceleration / (T * T * T * T)},
                                                    {4, {-1.0, 3.0, -3.0, 1.0}, 0.0}}};
  for (int j = 0; j < num_joints_; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const std::array<double, 3> most{T * limits_[k].v_max, T * T * limits_[k].a_max,
                                     T * T * T * limits_[k].j_max};
    for (std::size_t d = 0; d < kDifferences.size(); ++d) {
      const Difference& difference = kDifferences[d];
      for (int i = kFixed - difference.size + 1; i + difference.size <= kControlPoints; ++i) {
        double value = 0.0;
        std::array<double, kFree> share{};
        for (int p = 0; p < difference.size; ++p) {
          const double s = difference.share[static_cast<std::size_t>(p)];
          value += s * Point(c, i + p)[j];
          if (i + p >= kFixed) {
            share[static_cast<std::size_t>(FreeOf(i + p))] += s;
          }
        }
        Row* const row = std::any_of(share.begin(), share.end(), [](double s) { return s != 0.0; })
                             ? program_.NewRow()
                             : nullptr;  // of two equal points
        if (row == nullptr) {
          continue;
        }
        for (int a = 0; a < kFree; ++a) {
          const double s = share[static_cast<std::size_t>(a)];
          if (s == 0.0) {
            continue;
          }
          row->Add(a * num_joints_ + j, s);
          program_.g()[a * num_joints_ + j] += difference.weight * s * value;
          for (int b = 0; b < kFree; ++b) {
            program_.H()(a * num_joints_ + j, b * num_joints_ + j) +=
                difference.weight * s * share[static_cast<std::size_t>(b)];
          }
        }
        row->penalty = kPenaltyOfMotion;
        row->low = -most[d] - value;
        row->most = most[d] - value;
      }
    }
    const model::Joint& joint = config_.arm.joints[k];
    for (int a = 0; a < kFree; ++a) {
      const double value = c[a * num_joints_ + j];
      Row* const row = program_.NewRow();
      if (row == nullptr) {
        return;
      }
      row->Add(a * num_joints_ + j, 1.0);
      const double margin = config_.guard.joint_position_margin;
      row->penalty = kPenaltyOfMotion;
      row->low = std::clamp(joint.q_min + margin - value, -kLongestStep, 0.0);
      row->most = std::clamp(joint.q_max - margin - value, 0.0, kLongestStep);
    }
  }
}

void HorizonSearch::AddBarrier(int knot, const barriers::Barrier& barrier) noexcept {
  HorizonProgram::Row* const row = barrier.value < HUGE_VAL ? program_.NewRow() : nullptr;
  if (row == nullptr) {
    return;
  }
  std::array<double, kFree> share{};
  for (int i = 0; i < 3; ++i) {
    if (knot + i >= kFixed) {
      share[static_cast<std::size_t>(FreeOf(knot + i))] += kShares[static_cast<std::size_t>(i)];
    }
  }
  for (int a = 0; a < kFree; ++a) {
    for (int j = 0; j < num_joints_ && share[static_cast<std::size_t>(a)] != 0.0; ++j) {
      row->Add(a * num_joints_ + j, share[static_cast<std::size_t>(a)] * barrier.gradient[j]);
    }
  }
  // Past a margin it comes back slowly: at once it often cannot.
  row->low = std::min(barrier.margin - barrier.value, kReturn * knot * kKnotPeriod);
  row->most = HUGE_VAL;
}

// The feature's error at a knot, and what the arm must keep there.
void HorizonSearch::AddKnot(const Eigen::VectorXd& c, int knot, Work& work) noexcept {
  for (int i = 0; i < kWorkOfKnot; ++i) {
    work.Spend();
  }
  const model::VecN q = At(c, knot);
  Knot seen;
  if (!See(Sum(c, knot, PlaceShares()), knot, seen)) {
    return;
  }
  for (const Form& form : FormsAt(c, knot, seen)) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int point = knot + static_cast<int>(i);
      if (point < kFixed) {
        continue;
      }
      const int a = FreeOf(point) * num_joints_;
      program_.g().segment(a, num_joints_) += form.share[i] * form.g;
      for (std::size_t k = 0; k < 3; ++k) {
        const int other = knot + static_cast<int>(k);
        if (other >= kFixed) {
          program_.H().block(a, FreeOf(other) * num_joints_, num_joints_, num_joints_) +=
              form.share[i] * form.share[k] * form.G;
        }
      }
    }
  }
  model::ArmPoses poses;
  model::ComputePoses(config_.arm, q, poses);
  model::Mat6N J_C;
  model::ComputeJacobian(config_.arm, poses, config_.X_EC, J_C);
  for (const barriers::Barrier& side : barriers::FieldOfViewBarriers(
           config_.guard, {outline_, TargetAt(poses.X_BE * config_.X_EC, knot), J_C})) {
    AddBarrier(knot, side);
  }
  const barriers::ArmBodies bodies = barriers::PlaceBodies(config_.arm, poses);
  model::LinearJacobian J_E_B;
  model::ComputeLinearJacobian(config_.arm, poses, poses.X_BE.p, J_E_B);
  const model::VecN rest = model::VecN::Zero(num_joints_);
  for (int i = 0; i < solid_.size(); ++i) {
    const barriers::Barrier row = solid_.RowOf(i, {poses, bodies, J_E_B, rest});
    if (row.value - row.margin < kNearSolid) {
      AddBarrier(knot, row);
    }
  }
}

void HorizonSearch::Linearise(const Eigen::VectorXd& c, Work& work) noexcept {
  program_.Clear();
  AddMotion(c);
  for (int knot = 1; knot < kKnots; ++knot) {
    AddKnot(c, knot, work);
  }
  for (int i = 0; i < kWorkOfProgram; ++i) {
    work.Spend();
  }
}

PlanOutcome HorizonSearch::Search(const trajectory::PlanRequest& request, Work& work,
                                  trajectory::Plan& plan) noexcept {
  Begin(request);
  double cost = Cost(c_, work);
  if (!(cost < HUGE_VAL)) {
    return PlanOutcome::kTargetNotInSight;
  }
  for (int step = 0; step < kNewtonSteps; ++step) {
    Linearise(c_, work);
    const Eigen::VectorXd& change = program_.Solve();
    double share = 1.0;
    bool is_better = false;
    for (int halving = 0; halving <= kStepHalvings && !is_better; ++halving, share *= 0.5) {
      trial_ = c_ + share * change;
      const double next = Cost(trial_, work);
      // The first step makes the motion keep its limits, which the guess does not.
      is_better = next < cost || (step == 0 && halving == 0 && next < HUGE_VAL);
      cost = is_better ? next : cost;
    }
    if (!is_better) {
      break;
    }
    c_ = trial_;
  }
  if (!c_.allFinite()) {
    return PlanOutcome::kNoPath;
  }
  plan.period_s = kKnotPeriod;
  plan.num_points = kControlPoints;
  plan.turn = turn_;
  for (int i = 0; i < kControlPoints; ++i) {
    const model::VecN point = Point(c_, i);
    for (int j = 0; j < num_joints_; ++j) {
      plan.points[static_cast<std::size_t>(i * num_joints_ + j)] = point[j];
    }
  }
  return PlanOutcome::kFound;
}

}  // namespace fovea::planning
