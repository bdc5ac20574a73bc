// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/posture_space.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/barriers/disc_tilt_barrier.hpp"
#include "firmware/core/barriers/singularity.hpp"
#include "firmware/core/model/cholesky.hpp"

namespace fovea::planning {
namespace {

constexpr double kRoom = 0.001;        // of a path before solids [m]
constexpr double kProofRoom = 0.0005;  // a start nearer than this could not be proved to keep the margin [m]
constexpr double kSightRoom = 0.01;    // before lines of sight, because the mount is not known exactly [m]
constexpr double kLeastSightRoom = 0.003;  // the same if no goal or no path has more
// Before the edges of the picture, normalised: about what a mount that is turned by 1 degree moves the target
// by as the hand turns.
constexpr double kPictureRoom = 0.03;
// From a start with less, a path leads inward, and has that room from this distance on [rad]: along the edge
// it would crawl, because every motion towards a barrier is slow near it.
constexpr double kInward = 0.3;
constexpr double kOutside = 0.05;    // a start with the target further past the picture's bound is refused
constexpr double kTiltRoom = 0.02;   // before a disc's largest tilt, cosine
constexpr double kJointRoom = 0.02;  // before the ends of a joint's range [rad, m]
constexpr double kGoalJointRoom = 0.06;        // the same at the goal; kJointRoom if there is no other
constexpr double kSingularityRoom = 1.5;       // times the guard's smallest singular value, at the goal,
constexpr double kLeastSingularityRoom = 1.1;  // or if there is no other
// Smallest cosine between a flat target's normal and the line of sight: at a start that is planned from, on
// the way, unless the start has less, and on the way if there is no other. If there is none at all, a target
// that looks wide enough may be shown from an even steeper side.
constexpr double kEdgeOn = 0.1;
constexpr double kSteepest = 0.35;
constexpr double kLeastSteepest = 0.30;
constexpr double kWideSteepest = 0.21;
constexpr double kLeastWidth = 0.026;  // in the normalised image: 14 pixels of 640 that see 60 degrees
constexpr double kFacingRoom = 0.01;   // of this cosine, for a start that has less
// Largest absolute cosine of a corner in the picture, unless the start has more: 16.3 degrees. The detector
// finds corners down to 15.
constexpr double kSharpest = 0.96;
constexpr double kSharpRoom = 0.002;    // for a start that has more
constexpr double kReachRoom = 0.05;     // share of the detector's distances that a path keeps
constexpr double kNearestPoint = 0.05;  // of the target's points [m]
constexpr double kLookDamping = 1e-6;   // of J J^T
constexpr double kTurnMost = 0.3;       // of one LookStep [rad]
constexpr int kPulls = 5;
constexpr double kPullShare = 0.3;  // of the way to the picture's centre

Range RangeOf(const config::ServoConfig& config, double room) noexcept {
  Range range;
  range.least.resize(config.arm.num_joints);
  range.most.resize(config.arm.num_joints);
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const model::Joint& joint = config.arm.joints[static_cast<std::size_t>(i)];
    const double inside =
        std::min(config.guard.joint_position_margin + room, 0.5 * (joint.q_max - joint.q_min));
    range.least[i] = joint.q_min + inside;
    range.most[i] = joint.q_max - inside;
  }
  return range;
}

// The smallest height of a plate over one of its sides [m].
double NarrowestOf(const features::TargetOutline& outline) noexcept {
  const int n = outline.num_points;
  double narrowest = HUGE_VAL;
  for (int i = 0; i < n; ++i) {
    const model::Vec3& a = outline.p_OP[static_cast<std::size_t>(i)];
    const model::Vec3 side = outline.p_OP[static_cast<std::size_t>((i + 1) % n)] - a;
    double height = 0.0;
    for (int j = 0; j < n; ++j) {
      const model::Vec3 to = outline.p_OP[static_cast<std::size_t>(j)] - a;
      height = std::max(height, model::Cross(side, to).norm() / side.norm());
    }
    narrowest = std::min(narrowest, height);
  }
  return narrowest;
}

}  // namespace

PostureSpace::PostureSpace(const config::ServoConfig& config, const EyeReach& reach) noexcept
    : config_(config),
      detector_(reach),
      solid_(config),
      outline_(config.feature.Outline()),
      narrowest_(config.feature.SeesOrientation() ? NarrowestOf(outline_) : 0.0),
      levers_(barriers::Levers(config.arm, config.guard.hand)),
      range_(RangeOf(config, kJointRoom)),
      goal_range_(RangeOf(config, kGoalJointRoom)) {
  const int n = config.arm.num_joints;
  scale_.resize(n);
  for (int i = 0; i < n; ++i) {
    const bool turns = config.arm.joints[static_cast<std::size_t>(i)].type == model::JointType::kRevolute;
    scale_[i] = turns ? 1.0 : 1.0 / barriers::SingularityConfig{}.length;
  }
  // The margin of each solid's row does not depend on the posture.
  model::ArmPoses poses;
  model::ComputePoses(config.arm, model::ToVector(config.arm.q_ready, n), poses);
  const barriers::ArmBodies bodies = barriers::PlaceBodies(config.arm, poses);
  model::LinearJacobian J;
  model::ComputeLinearJacobian(config.arm, poses, poses.X_BE.p, J);
  for (int i = 0; i < solid_.size(); ++i) {
    const barriers::Barrier row = solid_.RowOf(i, {poses, bodies, J, model::VecN::Zero(n)});
    margin_[static_cast<std::size_t>(i)] = row.value == HUGE_VAL ? solid_.StopMarginOf(i) : row.margin;
  }
}

trajectory::PlanOutcome PostureSpace::Begin(const trajectory::PlanRequest& request,
                                            hal::Limit& blocker) noexcept {
  using trajectory::PlanOutcome;
  X_BO_ = request.X_BO;
  normal_B_ = request.normal_B;
  const model::VecN& q = request.start.q;
  range_ = RangeOf(config_, kJointRoom);
  goal_range_ = RangeOf(config_, kGoalJointRoom);
  singularity_room_ = kSingularityRoom;
  for (int i = 0; i < q.size(); ++i) {
    const model::Joint& joint = config_.arm.joints[static_cast<std::size_t>(i)];
    if (q[i] < joint.q_min || q[i] > joint.q_max) {
      blocker = hal::Limit::kJointPosition;
      return PlanOutcome::kStartNotClear;
    }
    range_.least[i] = std::min(range_.least[i], q[i]);
    range_.most[i] = std::max(range_.most[i], q[i]);
  }
  Work none(1);
  Posture start;
  steepest_ = kEdgeOn;
  wide_steepest_ = HUGE_VAL;
  sharpest_ = 1.0;
  reach_ = detector_;
  Place(q, none, start);
  q_start_ = q;
  start_room_ = 0.0;
  if (!start.is_faced || !(PictureRoom(start) > -kOutside)) {
    blocker = hal::Limit::kFieldOfView;
    return PlanOutcome::kTargetNotInSight;
  }
  const barriers::ArmBodies bodies = barriers::PlaceBodies(config_.arm, start.poses);
  for (int i = 0; i < solid_.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double value = solid_.ValueOf(i, start.poses, bodies);
    if (value < solid_.StopMarginOf(i)) {
      blocker = solid_.NameOf(i);
      return PlanOutcome::kStartNotClear;
    }
    room_[k] = std::min(kRoom, value - margin_[k]);
    bound_[k] = value - margin_[k] < kProofRoom ? solid_.StopMarginOf(i) : margin_[k];
  }
  const double distance = start.X_CO.p.norm();
  reach_.nearest = std::min((1.0 + kReachRoom) * detector_.nearest, distance);
  reach_.farthest = std::max((1.0 - kReachRoom) * detector_.farthest, distance);
  steepest_ = std::max(kEdgeOn, std::min(kSteepest, CosineTo(start) - kFacingRoom));
  sharpest_ = std::max(kSharpest, SharpestCorner(start) + kSharpRoom);
  start_room_ = std::min(kPictureRoom, PictureRoom(start));
  sight_room_ = std::min(kSightRoom, SightRoom(start, bodies));
  tilt_room_ = std::min(kTiltRoom, Tilt(start));
  return PlanOutcome::kFound;
}

bool PostureSpace::AllowTightGoals() noexcept {
  const bool is_new = singularity_room_ > kLeastSingularityRoom;
  sight_room_ = std::min(sight_room_, kLeastSightRoom);
  singularity_room_ = kLeastSingularityRoom;
  goal_range_ = RangeOf(config_, kJointRoom);
  return is_new;
}

void PostureSpace::AllowNarrowPassages() noexcept {
  sight_room_ = std::min(sight_room_, kLeastSightRoom);
  steepest_ = std::min(steepest_, kLeastSteepest);
}

void PostureSpace::AllowSteepViews() noexcept { wide_steepest_ = std::min(steepest_, kWideSteepest); }

void PostureSpace::Place(const model::VecN& q, Work& work, Posture& posture) const noexcept {
  work.Spend();
  posture.q = q;
  model::ComputePoses(config_.arm, q, posture.poses);
  posture.X_BC = posture.poses.X_BE * config_.X_EC;
  posture.X_CO = posture.X_BC.Inverse() * X_BO_;
  model::ComputeJacobian(config_.arm, posture.poses, config_.X_EC, posture.J_C);
  const double distance = posture.X_CO.p.norm();
  bool faced = IsFaced(posture) && distance >= reach_.nearest && distance <= reach_.farthest;
  for (int i = 0; i < outline_.num_points; ++i) {
    faced = faced && (posture.X_CO * outline_.p_OP[static_cast<std::size_t>(i)]).z() > kNearestPoint;
  }
  faced = faced && SharpestCorner(posture) <= sharpest_;
  posture.is_faced = faced;
  if (faced) {
    posture.picture = barriers::FieldOfViewBarriersOnPlan(
        config_.guard, {outline_, {posture.X_CO, model::Vec3::Zero(), model::Vec3::Zero()}, posture.J_C});
  }
}

bool PostureSpace::IsFaced(const Posture& posture) const noexcept {
  if (!config_.feature.SeesOrientation()) {
    return true;
  }
  const double cosine = CosineTo(posture);
  return cosine > steepest_ ||
         (cosine > wide_steepest_ && narrowest_ * cosine > kLeastWidth * posture.X_CO.p.norm());
}

double PostureSpace::CosineTo(const Posture& posture) noexcept {
  return posture.X_CO.R.col(2).dot(posture.X_CO.p) / posture.X_CO.p.norm();
}

double PostureSpace::SharpestCorner(const Posture& posture) const noexcept {
  double sharpest = 0.0;
  if (config_.feature.SeesOrientation() && config_.guard.view.enabled) {
    const int n = outline_.num_points;
    const auto at = [&](int i) {
      const model::Vec3 p_C = posture.X_CO * outline_.p_OP[static_cast<std::size_t>(i % n)];
      return Eigen::Vector2d(p_C.head<2>() / p_C.z());
    };
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector2d corner = at(i + 1);
      const Eigen::Vector2d a = at(i) - corner;
      const Eigen::Vector2d b = at(i + 2) - corner;
      sharpest = std::max(sharpest, std::fabs(a.dot(b)) / (a.norm() * b.norm()));
    }
  }
  return sharpest;
}

double PostureSpace::PictureRoom(const Posture& posture) const noexcept {
  double least = HUGE_VAL;
  for (const barriers::Barrier& side : posture.picture) {
    least = std::min(least, side.value - side.margin);
  }
  return least - NeededRoom(posture.q);
}

double PostureSpace::RoomAt(const model::VecN& q, double at_start, double at_last) const noexcept {
  const double share = std::min(Distance(q, q_start_) / kInward, 1.0);
  return at_start + share * (at_last - at_start);
}

double PostureSpace::NeededRoom(const model::VecN& q) const noexcept {
  return RoomAt(q, start_room_, kPictureRoom);
}

barriers::Sight PostureSpace::SightAt(const Posture& posture,
                                      const barriers::ArmBodies& bodies) const noexcept {
  return {posture.poses, bodies, posture.X_BC, outline_, X_BO_, config_.guard.obstacles};
}

double PostureSpace::SightRoom(const Posture& posture, const barriers::ArmBodies& bodies) const noexcept {
  const double margin = config_.guard.sight_clearance;
  return margin > 0.0 ? barriers::ClearanceOfSight(SightAt(posture, bodies)) - margin : HUGE_VAL;
}

double PostureSpace::Tilt(const Posture& posture) const noexcept {
  if (normal_B_.isZero() || !config_.guard.view.enabled) {
    return HUGE_VAL;
  }
  const barriers::Barrier tilt = barriers::DiscTiltBarrier(
      config_.guard, posture.X_CO.p, posture.X_BC.R.transpose() * normal_B_, posture.J_C);
  return tilt.value - tilt.margin;
}

PostureSpace::Verdict PostureSpace::Judge(const Posture& posture, double share) const noexcept {
  // A room below 0, at a start past a bound, is not shared: the path must not be further out.
  const auto needed = [share](double room) { return room > 0.0 ? share * room : room; };
  Verdict verdict;
  verdict.blocker = hal::Limit::kFieldOfView;
  const double picture_room = NeededRoom(posture.q);
  if (!posture.is_faced || !(PictureRoom(posture) + picture_room >= needed(picture_room)) ||
      !(Tilt(posture) >= needed(RoomAt(posture.q, tilt_room_, kTiltRoom)))) {
    return verdict;
  }
  const barriers::ArmBodies bodies = barriers::PlaceBodies(config_.arm, posture.poses);
  verdict.travel = HUGE_VAL;
  for (int i = 0; i < solid_.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double value = solid_.ValueOf(i, posture.poses, bodies);
    if (!(value - margin_[k] >= needed(room_[k]))) {
      verdict.blocker = solid_.NameOf(i);
      return verdict;
    }
    verdict.travel = std::min(verdict.travel, solid_.ShareOf(i) * (value - bound_[k]));
  }
  if (!(SightRoom(posture, bodies) >= needed(sight_room_))) {
    return verdict;
  }
  verdict.is_free = true;
  return verdict;
}

bool PostureSpace::IsFree(const model::VecN& q, Work& work) const noexcept {
  Posture posture;
  Place(q, work, posture);
  return Judge(posture).is_free;
}

bool PostureSpace::IsRegular(const Posture& posture) const noexcept {
  barriers::Singularity singularity;
  barriers::ComputeSingularity(posture.J_C, barriers::SingularityConfig{}.length, singularity);
  return singularity.sigma > singularity_room_ * config_.guard.singularity_min;
}

model::VecN PostureSpace::LookStep(const Posture& posture, const model::Vec3& d_C,
                                   double share) const noexcept {
  // The direction d to the target: dd/dt = [d]x w - (I - d d^T) v / |p| for the camera's twist [v; w].
  const double away = std::max(posture.X_CO.p.norm(), kNearestPoint);
  const model::Vec3 d = posture.X_CO.p / away;
  const model::Mat3 across = (model::Mat3::Identity() - d * d.transpose()) / away;
  const model::LinearJacobian A = model::CrossMatrix(d).lazyProduct(posture.J_C.bottomRows<3>()) -
                                  across.lazyProduct(posture.J_C.topRows<3>());
  model::Mat3 AAT = A.lazyProduct(A.transpose());
  AAT.diagonal().array() += kLookDamping;
  model::FactorCholesky(AAT);
  model::Vec3 x = share * (d_C - d);
  model::SolveCholesky(AAT, x);
  model::VecN step = A.transpose().lazyProduct(x);
  const double largest = step.cwiseProduct(scale_).lpNorm<Eigen::Infinity>();
  step *= largest > kTurnMost ? kTurnMost / largest : 1.0;
  return range_.Clamped(posture.q + step);
}

bool PostureSpace::PullIntoView(model::VecN& q, Work& work, Posture& posture) const noexcept {
  for (int pull = 0; pull <= kPulls; ++pull) {
    Place(q, work, posture);
    if (posture.is_faced && PictureRoom(posture) >= 0.0) {
      return true;
    }
    q = LookStep(posture, model::Vec3::UnitZ(), kPullShare);
  }
  return false;
}

void PostureSpace::LimitsAt(const Posture& posture, const model::VecN& dq,
                            barriers::MotionLimits& limits) const noexcept {
  barriers::LimitJoints(config_, posture.q, limits);
  const barriers::ArmBodies bodies = barriers::PlaceBodies(config_.arm, posture.poses);
  model::LinearJacobian J_E_B;
  model::ComputeLinearJacobian(config_.arm, posture.poses, posture.poses.X_BE.p, J_E_B);
  for (int i = 0; i < solid_.size(); ++i) {
    limits.Add(solid_.RowOf(i, {posture.poses, bodies, J_E_B, dq}));
  }
  for (const barriers::Barrier& side : posture.picture) {
    limits.Add(side);
  }
  limits.Add(barriers::LineOfSightBarrier(config_, SightAt(posture, bodies), posture.J_C));
  if (config_.guard.view.enabled && !normal_B_.isZero()) {
    limits.Add(barriers::DiscTiltBarrier(config_.guard, posture.X_CO.p,
                                         posture.X_BC.R.transpose() * normal_B_, posture.J_C));
  }
}

}  // namespace fovea::planning
