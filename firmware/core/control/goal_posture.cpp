// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/goal_posture.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "firmware/core/control/posture_checks.hpp"
#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/math.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::control {
namespace {

using features::FeatureForm;
using model::Mat3;
using model::Pose;
using model::Vec6;
using model::VecN;

constexpr double kStepMost = 0.2;     // [rad]
constexpr double kDamping = 1e-6;     // of J J^T, against a singular matrix [m^2, rad^2]
constexpr double kReached = 2e-3;     // a goal this near is reached; later steps remove the rest [m, rad]
constexpr double kOff = 0.01;         // a found posture is dropped if it is further off the goal than this
constexpr int kOffSteps = 25;         // in more than this number of steps in a row
constexpr double kLost = 0.5;         // or once further off the goal than this
constexpr int kStepsMost = 100;       // of a trial; then the trial fails
constexpr int kStepsLooked = 8;       // a trial fails if after this number of steps
constexpr double kComesNearer = 0.8;  // its distance has not fallen to this share
constexpr int kPasses = 3;            // of one step, to find joints at the ends of their ranges
constexpr double kSpread = 0.5;       // of the first round's starts; each round adds as much [rad]
constexpr int kTrialsInRound = 16;    // for each turn
constexpr int kRounds = 12;           // then the search restarts: limits, target or arm may have moved
constexpr int kTrialsForClear = 192;  // then a posture without a clear path is taken too
constexpr double kBarred = 100.0;     // added to the length of a barred path [rad]
constexpr double kSame = 0.2;         // postures no further apart are the same [rad]
constexpr int kDetours = 6;           // number tried if the straight path is barred
constexpr double kDetour = 1.5;       // a detour starts towards a posture up to this far away [rad]
constexpr int kDetourSteps = 4;       // of a detour, at least
constexpr int kDetourStepsMore = 11;  // and up to this many more

int TurnsOf(const features::TargetFeature& feature) noexcept {
  return features::TraitsOf(feature.target).turns;
}

// The camera's goal pose.
Pose CameraGoal(const features::TargetFeature& feature, const Pose& X_BO, int turn) noexcept {
  const Pose turned{X_BO.R * EqualTurn(turn, TurnsOf(feature)), X_BO.p};
  return turned * Pose{feature.R_CO_star, feature.p_CO_C_star}.Inverse();
}

Pose HandGoal(const config::ServoConfig& config, const Pose& X_BO, int turn) noexcept {
  return CameraGoal(config.feature, X_BO, turn) * config.X_EC.Inverse();
}

// The turn in place `rank`: `first`, then the others, nearest to the camera's orientation first.
int TurnOfRank(const config::ServoConfig& config, const Pose& X_BO, const VecN& q, int first,
               int rank) noexcept {
  const int turns = TurnsOf(config.feature);
  if (turns == 1) {
    return 0;
  }
  model::ArmPoses poses;
  model::ComputePoses(config.arm, q, poses);
  const Pose X_BC = poses.X_BE * config.X_EC;
  std::array<double, features::Polygon::kMost> likeness{};
  likeness.fill(-HUGE_VAL);  // turns that the target does not have come last
  for (int i = 0; i < turns; ++i) {
    likeness[static_cast<std::size_t>(i)] = X_BC.R.cwiseProduct(CameraGoal(config.feature, X_BO, i).R).sum();
  }
  std::array<int, features::Polygon::kMost> order{0, 1, 2, 3};
  std::swap(order[0], order[static_cast<std::size_t>(first)]);
  std::sort(order.begin() + 1, order.end(), [&](int a, int b) {
    return likeness[static_cast<std::size_t>(a)] > likeness[static_cast<std::size_t>(b)];
  });
  return order[static_cast<std::size_t>(rank)];
}

// Uniform in [-1, 1]: the quick generator of Numerical Recipes.
double Draw(std::uint32_t& state) noexcept {
  state = state * 1664525U + 1013904223U;
  return static_cast<double>(state >> 8U) * 0x1p-23 - 1.0;
}

void Begin(const config::ServoConfig& config, const Pose& X_BO, const VecN& q, GoalPosture& goal) noexcept {
  const int turns = TurnsOf(config.feature);
  const int rank = goal.trial % turns;
  goal.trial_turn = goal.trial < turns ? TurnOfRank(config, X_BO, q, goal.turn, rank) : rank;
  const int round = goal.trial / (turns * kTrialsInRound);
  goal.begun = true;
  goal.step = 0;
  goal.last_off = HUGE_VAL;
  goal.q = q;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const JointRange range = RoomOfJoint(config, i);
    if (goal.trial >= turns) {
      goal.q[i] += kSpread * (1.0 + round) * Draw(goal.random);
    }
    goal.q[i] = std::clamp(goal.q[i], range.least, range.most);
  }
}

// The camera's distance `off` from its goal, and the Jacobian with J dq = off. If the target's orientation is
// not seen, the camera may turn about it, and dp_CO/dt = -v + [p_CO]x w must be p_CO* - p_CO.
void OffGoal(const config::ServoConfig& config, const Pose& X_BO, int turn, const model::ArmPoses& poses,
             Vec6& off, model::Mat6N& J) noexcept {
  const Pose X_BC = poses.X_BE * config.X_EC;
  model::ComputeJacobian(config.arm, poses, config.X_EC, J);
  if (config.feature.SeesOrientation()) {
    const Pose X_BC_star = CameraGoal(config.feature, X_BO, turn);
    off.head<3>() = X_BC.R.transpose() * (X_BC_star.p - X_BC.p);
    off.tail<3>() = model::RotationVector(X_BC.R.transpose() * X_BC_star.R);
  } else {
    const model::Vec3 p_CO = X_BC.Inverse() * X_BO.p;
    off.head<3>() = p_CO - config.feature.p_CO_C_star;
    off.tail<3>().setZero();
    J.topRows<3>() -= model::CrossMatrix(p_CO).lazyProduct(J.bottomRows<3>());
    J.bottomRows<3>().setZero();
  }
}

// One Gauss-Newton step towards the goal. A joint at the end of its range stays if the step would move it
// out. Returns the distance from the goal before the step.
double Descend(const config::ServoConfig& config, const Pose& X_BO, int turn, const model::ArmPoses& poses,
               VecN& q) noexcept {
  Vec6 off;
  model::Mat6N J;
  OffGoal(config, X_BO, turn, poses, off, J);
  VecN dq = VecN::Zero(q.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    model::Mat6 JJT = J.lazyProduct(J.transpose());
    JJT.diagonal().array() += kDamping;
    model::FactorCholesky(JJT);
    Vec6 x = off;
    model::SolveCholesky(JJT, x);
    dq = J.transpose().lazyProduct(x);
    const double largest = dq.lpNorm<Eigen::Infinity>();
    dq *= largest > kStepMost ? kStepMost / largest : 1.0;
    bool held = false;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const JointRange range = RoomOfJoint(config, i);
      if ((q[i] >= range.most && dq[i] > 0.0) || (q[i] <= range.least && dq[i] < 0.0)) {
        J.col(i).setZero();
        held = true;
      }
    }
    if (!held) {
      break;
    }
  }
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const JointRange range = RoomOfJoint(config, i);
    q[i] = std::clamp(q[i] + dq[i], range.least, range.most);
  }
  return off.norm();
}

bool WasDropped(const GoalPosture& goal) noexcept {
  bool dropped = false;
  for (int i = 0; i < std::min(goal.drops, GoalPosture::kDropsKept); ++i) {
    const VecN& q_dropped = goal.q_dropped[static_cast<std::size_t>(i)];
    dropped = dropped || (goal.q - q_dropped).lpNorm<Eigen::Infinity>() < kSame;
  }
  return dropped;
}

// Records a tried path to a posture that reaches the goal.
void Note(GoalPosture& goal) noexcept {
  const double way = goal.way.length + (goal.way.barred ? kBarred : 0.0);
  const bool counts = goal.detour == 0 || !goal.way.barred;
  if (counts && way < goal.nearest) {
    goal.nearest = way;
    goal.nearest_turn = goal.trial_turn;
    goal.nearest_detour = goal.detour > 0;
    goal.q_nearest = goal.q;
    goal.q_nearest_via = goal.q_via;
  }
}

// Starts another detour from `q`, towards a random posture about `q`.
void BeginDetour(const config::ServoConfig& config, const VecN& q, GoalPosture& goal) noexcept {
  ++goal.detour;
  goal.turned = false;
  goal.q_via = q;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const JointRange range = RoomOfJoint(config, i);
    goal.q_via[i] = std::clamp(q[i] + kDetour * Draw(goal.random), range.least, range.most);
  }
  const double share = 0.5 * (1.0 + Draw(goal.random));
  goal.detour_steps = kDetourSteps + static_cast<int>(share * kDetourStepsMore);
  goal.way = WayTrial{};
  goal.way.q = q;
}

// One step along the tried path. False at its end, reached or barred.
bool TryOn(const config::ServoConfig& config, const Pose& X_BO, GoalPosture& goal) noexcept {
  if (goal.detour == 0 || goal.turned) {
    return StepOnWay(config, X_BO, goal.q, goal.way);
  }
  const bool goes_on = StepOnWay(config, X_BO, goal.q_via, goal.way);
  if (goal.way.barred) {
    return false;
  }
  if (!goes_on || goal.way.steps >= goal.detour_steps) {
    goal.turned = true;
    goal.q_via = goal.way.q;
  }
  return true;
}

// Ends the trial. A posture found by descent from the arm's posture counts at once, others at the end of the
// round.
void NextTrial(const config::ServoConfig& config, GoalPosture& goal) noexcept {
  const int turns = TurnsOf(config.feature);
  goal.downhill = goal.trial < turns;
  goal.begun = false;
  goal.reached = false;
  ++goal.trial;
  const bool round_over = goal.trial % (turns * kTrialsInRound) == 0;
  if (goal.trial >= turns * kTrialsInRound * kRounds) {
    goal.trial = 0;
  }
  goal.clear = goal.nearest < kBarred;
  const bool enough = goal.clear || goal.trial == 0 || goal.trial >= kTrialsForClear;
  if (goal.nearest < HUGE_VAL && (goal.downhill || (round_over && enough))) {
    goal.found = true;
    goal.turn = goal.nearest_turn;
    goal.detour = goal.nearest_detour ? 1 : 0;
    goal.q = goal.q_nearest;
    goal.q_via = goal.q_nearest_via;
    goal.nearest = HUGE_VAL;
    goal.step = 0;
  }
}

}  // namespace

bool SeeksWhenIdle(const config::ServoConfig& config) noexcept {
  return !config.feature.SeesOrientation() && !config.feature.hold_orientation;
}

bool SeeksGoalPosture(const config::ServoConfig& config) noexcept {
  const features::TargetFeature& feature = config.feature;
  const bool whole_pose = feature.SeesOrientation() &&
                          (feature.form == FeatureForm::kCorners || feature.form == FeatureForm::kPose);
  return config.arm.num_joints >= 6 && (whole_pose || SeeksWhenIdle(config));
}

Mat3 EqualTurn(int turn, int turns) noexcept {
  model::SinCosResult by{0.0, 1.0};
  if (4 * turn % turns == 0) {
    constexpr std::array<double, 4> kCos{1.0, 0.0, -1.0, 0.0};
    const int quarters = 4 * turn / turns;
    by.cos = kCos[static_cast<std::size_t>(quarters & 3)];
    by.sin = kCos[static_cast<std::size_t>((quarters + 3) & 3)];
  } else {
    by = model::SinCos(2.0 * model::kPi * turn / turns);
  }
  Mat3 R;
  R << by.cos, -by.sin, 0.0, by.sin, by.cos, 0.0, 0.0, 0.0, 1.0;
  return R;
}

void SeekAnew(GoalPosture& goal) noexcept {
  const int turn = goal.turn;
  const std::uint32_t random = goal.random;
  goal = GoalPosture{};
  goal.turn = turn;
  goal.random = random;
}

void SeekClearerPosture(GoalPosture& goal) noexcept {
  goal.found = false;
  goal.begun = false;
  goal.reached = false;
  ++goal.trial;
}

void DropGoalPosture(GoalPosture& goal) noexcept {
  goal.q_dropped[static_cast<std::size_t>(goal.drops % GoalPosture::kDropsKept)] = goal.q;
  ++goal.drops;
  SeekClearerPosture(goal);
}

void SeekGoalPosture(const config::ServoConfig& config, const Pose& X_BO, const VecN& q,
                     GoalPosture& goal) noexcept {
  if (goal.reached && !goal.found) {
    if (!TryOn(config, X_BO, goal)) {
      Note(goal);
      if (goal.way.barred && goal.detour < kDetours) {
        BeginDetour(config, q, goal);
      } else {
        NextTrial(config, goal);
      }
    }
    return;
  }
  if (!goal.begun && !goal.found) {
    Begin(config, X_BO, q, goal);
  }
  const int turn = goal.found ? goal.turn : goal.trial_turn;
  model::ArmPoses poses;
  model::ComputePoses(config.arm, goal.q, poses);
  const bool turns_freely = !config.feature.SeesOrientation();
  const Pose X_BE_star = turns_freely ? poses.X_BE : HandGoal(config, X_BO, turn);
  const bool allowed = KeepsOut(config, X_BE_star);
  if (!goal.found && !turns_freely && !allowed) {
    NextTrial(config, goal);
    return;
  }
  const double off = Descend(config, X_BO, turn, poses, goal.q);
  if (goal.found) {
    goal.step = off > kOff || !allowed ? goal.step + 1 : 0;
    if (!(off < kLost) || goal.step > kOffSteps) {
      SeekAnew(goal);
    }
    return;
  }
  ++goal.step;
  bool is_stuck = goal.step >= kStepsMost;
  if (goal.step % kStepsLooked == 1) {
    is_stuck = is_stuck || !(off < kComesNearer * goal.last_off);
    goal.last_off = off;
  }
  if (off < kReached && allowed && IsRegular(config, poses) && IsArmClear(config, poses, X_BO) &&
      !WasDropped(goal)) {
    goal.reached = true;
    goal.detour = 0;
    goal.q_via = q;
    goal.way = WayTrial{};
    goal.way.q = q;
  } else if (off < kReached || is_stuck) {
    NextTrial(config, goal);
  }
}

}  // namespace fovea::control
