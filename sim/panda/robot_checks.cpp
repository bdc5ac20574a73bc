// SPDX-License-Identifier: Apache-2.0
// Checks the measured motion against the robot's limits.
#include <algorithm>
#include <cmath>

#include "sim/panda/robot.hpp"

namespace fovea::sim {
namespace {

using franka::Error;
using franka::MoveController;

constexpr double kMeasuredMargin = 1.05;  // limit of a measured speed, relative to that of a commanded one
constexpr double kNearItself = 0.01;      // a predicted gap between links below this is a collision [m]

template <typename Flags>
bool Any(const Flags& flags) {
  return std::any_of(flags.begin(), flags.end(), [](double flag) { return flag != 0.0; });
}

}  // namespace

void FciRobot::CheckDeviation(const franka::Vector3& most, Error error) {
  const Eigen::Isometry3d X_d = chain_.TipPose(reference_.joints().q);
  const Eigen::AngleAxisd turn(X_d.linear() * X_BE_.linear().transpose());
  const bool external = move_.controller == MoveController::kExternal;
  if (!external && ((X_d.translation() - X_BE_.translation()).norm() > most[0] || turn.angle() > most[1] ||
                    std::fabs(reference_.joints().q[2] - measured_.q[2]) > most[2])) {
    Reflex(error);
  }
}

// Largest distance of a joint outside its range [rad]; negative: all are inside.
double FciRobot::JointsBeyond() const {
  return std::max((measured_.q - fci_limits::kQMax).maxCoeff(), (fci_limits::kQMin - measured_.q).maxCoeff());
}

bool FciRobot::IsInWall() const {
  const Eigen::Vector3d p_BEE = (X_BE_ * F_T_EE()).translation();
  return std::any_of(walls_.begin(), walls_.end(),
                     [&](const CartesianWall& wall) { return wall.Holds(p_BEE); });
}

// Whether two links approach each other and can no longer stop in time.
bool FciRobot::MeetsItself() const {
  const Joints& dq = measured_.dq;
  const Joints q_rest = measured_.q + dq.cwiseProduct(dq.cwiseAbs()).cwiseQuotient(2.0 * fci_limits::kDdq);
  const double then = self_distance_.Least(chain_.LinkPoses(q_rest));
  return then < kNearItself && then < self_distance_.Least(chain_.LinkPoses(measured_.q));
}

std::optional<Error> FciRobot::SpeedError() const {
  const Twist V = J_ * measured_.dq;
  if (((measured_.dq.cwiseAbs() - kMeasuredMargin * fci_limits::kDq).array() > 0.0).any()) {
    return Error::kJointVelocity;
  }
  if (V.head<3>().norm() > kMeasuredMargin * fci_limits::kTranslation.velocity ||
      V.tail<3>().norm() > kMeasuredMargin * fci_limits::kRotation.velocity) {
    return Error::kCartesianVelocity;
  }
  return std::nullopt;
}

void FciRobot::CheckMotion() {
  if (JointsBeyond() > fci_limits::kBeyond) {
    Reflex(Error::kJointPositionLimits);
  } else if (const auto error = SpeedError()) {
    Reflex(*error);
  } else if (IsInWall()) {
    Reflex(Error::kCartesianPositionLimits);
  } else if (MeetsItself()) {
    Reflex(Error::kSelfCollisionAvoidance);
  } else if (swing_watch_.Step(measured_.dq)) {
    Reflex(Error::kInstabilityDetection);
  } else if (((ToVector(state_.tau_J).cwiseAbs() - fci_limits::kTau).array() > 0.0).any()) {
    Reflex(Error::kTauJRange);
  } else if (Any(state_.joint_collision)) {
    Reflex(Error::kJointReflex);
  } else if (Any(state_.cartesian_collision)) {
    Reflex(Error::kCartesianReflex);
  }
  if (moving() && commanded_) {
    CheckDeviation(move_.max_path_deviation, Error::kMaxPathPoseDeviation);
  }
}

// A joint or hand outside its limits when guiding began may move back, but not farther out.
void FciRobot::CheckGuiding() {
  const double beyond = JointsBeyond();
  const bool in_wall = IsInWall();
  if (beyond > guiding_.beyond + fci_limits::kBeyond) {
    Reflex(guiding_.beyond > 0.0 ? Error::kJointMoveInWrongDirection : Error::kJointPositionLimits);
  } else if (in_wall && !guiding_.in_wall) {
    Reflex(Error::kCartesianPositionLimits);
  } else if (const auto error = SpeedError()) {
    Reflex(*error);
  }
  guiding_.beyond = std::clamp(beyond, 0.0, guiding_.beyond);
  guiding_.in_wall = guiding_.in_wall && in_wall;
}

}  // namespace fovea::sim
