// SPDX-License-Identifier: Apache-2.0
#include "sim/panda/reference.hpp"

#include <cmath>
#include <numbers>

#include "sim/panda/settings.hpp"

namespace fovea::sim {
namespace {

using franka::Error;
using franka::MoveGenerator;
using franka::RobotCommand;
using MaybeError = std::optional<Error>;

constexpr double kDt = kFciStepS;
constexpr double kStartTolerance = 0.01;  // largest distance of the first command from the robot [rad, m]
constexpr int kMostIterations = 20;
constexpr double kSolved = 1e-12;  // [m, rad]

// Share of a step that a first-order low pass lets through in one period; all of it at 1000 Hz.
double FilterShare(double cutoff_hz) {
  const double w = 2.0 * std::numbers::pi * cutoff_hz * kDt;
  return cutoff_hz >= 1000.0 ? 1.0 : w / (1.0 + w);
}

// The rotation vector from R_0 to R_1, in the common base frame of both.
Eigen::Vector3d Turn(const Eigen::Matrix3d& R_0, const Eigen::Matrix3d& R_1) {
  const Eigen::AngleAxisd turn(R_1 * R_0.transpose());
  return turn.angle() * turn.axis();
}

Eigen::Isometry3d Moved(const Eigen::Isometry3d& X, const Twist& step) {
  Eigen::Isometry3d moved = X;
  moved.translation() += step.head<3>();
  const double angle = step.tail<3>().norm();
  if (angle > 0.0) {
    const Eigen::AngleAxisd turn(angle, step.tail<3>() / angle);
    moved.linear() = Eigen::Quaterniond(turn * X.linear()).normalized().toRotationMatrix();
  }
  return moved;
}

Twist Between(const Eigen::Isometry3d& X_0, const Eigen::Isometry3d& X_1) {
  Twist step;
  step << X_1.translation() - X_0.translation(), Turn(X_0.linear(), X_1.linear());
  return step;
}

bool Beyond(const Joints& values, const Joints& limits) {
  return ((values.cwiseAbs() - fci_limits::kRounding * limits).array() > 0.0).any();
}

}  // namespace

bool FciReference::IsCartesian() const {
  return generator_ == MoveGenerator::kCartesianPosition || generator_ == MoveGenerator::kCartesianVelocity;
}

void FciReference::Hold(const Joints& q, const Joints& dq) {
  joints_ = {q, dq, Joints::Zero()};
  StepToRest();
}

void FciReference::StepToRest() {
  const Joints most = fci_limits::kDdq * kDt;
  const Joints dq = joints_.dq - joints_.dq.cwiseMax(-most).cwiseMin(most);
  joints_.ddq = (dq - joints_.dq) / kDt;
  joints_.q += dq * kDt;
  joints_.dq = dq;
}

void FciReference::Begin(MoveGenerator generator, const Eigen::Isometry3d& F_T_EE,
                         const franka::Filters& filters) {
  generator_ = generator;
  filters_ = filters;
  F_T_EE_ = F_T_EE;
  first_ = true;
  elbow_given_ = false;
  joints_.dq.setZero();
  joints_.ddq.setZero();
  cartesian_ = {};
  cartesian_.X = chain_.TipPose(joints_.q) * F_T_EE_;
  cartesian_.elbow[0] = joints_.q[2];
  cartesian_.elbow_sign = joints_.q[3] < 0.0 ? -1.0 : 1.0;
}

MaybeError FciReference::CheckStart(const RobotCommand& c) const {
  switch (generator_) {
    case MoveGenerator::kJointPosition:
      if ((ToVector(c.q_c) - joints_.q).cwiseAbs().maxCoeff() > kStartTolerance) {
        return Error::kJointPositionStartPoseInvalid;
      }
      break;
    case MoveGenerator::kCartesianPosition:
      if (Between(cartesian_.X, ToPose(c.O_T_EE_c)).cwiseAbs().maxCoeff() > kStartTolerance) {
        return Error::kCartesianPositionStartPoseInvalid;
      }
      break;
    default: break;
  }
  if (IsCartesian() && c.valid_elbow != 0) {
    if (c.elbow_c[1] * cartesian_.elbow_sign < 0.0) {
      return Error::kStartElbowSignInconsistent;
    }
    if (std::fabs(c.elbow_c[0] - cartesian_.elbow[0]) > kStartTolerance) {
      return Error::kCartesianStartElbowInvalid;
    }
  }
  return std::nullopt;
}

MaybeError FciReference::Step(const RobotCommand& c) {
  const bool position = generator_ == MoveGenerator::kCartesianPosition;
  if (position && !IsPose(c.O_T_EE_c)) {
    return Error::kCartesianPositionInvalidFrame;
  }
  if (first_) {
    if (const MaybeError error = CheckStart(c)) {
      return error;
    }
    first_ = false;
    elbow_given_ = IsCartesian() && c.valid_elbow != 0;
  }
  const auto elbow = elbow_given_ && c.valid_elbow != 0 ? std::optional(c.elbow_c) : std::nullopt;
  switch (generator_) {
    case MoveGenerator::kJointPosition: {
      const Joints step = FilterShare(filters_.joint_position) * (ToVector(c.q_c) - joints_.q);
      return StepJoints(joints_.q + step, step / kDt);
    }
    case MoveGenerator::kJointVelocity: {
      const Joints dq = joints_.dq + FilterShare(filters_.joint_velocity) * (ToVector(c.dq_c) - joints_.dq);
      return StepJoints(joints_.q + dq * kDt, dq);
    }
    case MoveGenerator::kCartesianPosition: {
      const Twist step = FilterShare(filters_.cartesian_position) * Between(cartesian_.X, ToPose(c.O_T_EE_c));
      return StepPose(Moved(cartesian_.X, step), step / kDt, elbow);
    }
    case MoveGenerator::kCartesianVelocity: {
      const Twist V =
          cartesian_.V + FilterShare(filters_.cartesian_velocity) * (ToVector(c.O_dP_EE_c) - cartesian_.V);
      return StepPose(Moved(cartesian_.X, V * kDt), V, elbow);
    }
  }
  return Error::kForceControlSafety;  // no such generator; Move refuses it
}

MaybeError FciReference::Finish() const {
  using fci_limits::kRotation;
  using fci_limits::kTranslation;
  if (IsCartesian() &&
      (cartesian_.V.head<3>().norm() > fci_limits::kRounding * kTranslation.acceleration * kDt ||
       cartesian_.V.tail<3>().norm() > fci_limits::kRounding * kRotation.acceleration * kDt)) {
    return Error::kCartesianVelocityDiscontinuity;
  }
  if (Beyond(joints_.dq / kDt, fci_limits::kDdq)) {
    return IsCartesian() ? Error::kCartesianJointVelocityDiscontinuity : Error::kJointVelocityDiscontinuity;
  }
  return std::nullopt;
}

MaybeError FciReference::Extrapolate() {
  if (first_) {
    return std::nullopt;  // nothing has moved yet
  }
  if (!IsCartesian()) {
    const Joints dq = joints_.dq + joints_.ddq * kDt;
    return StepJoints(joints_.q + dq * kDt, dq);
  }
  const Twist V = cartesian_.V + cartesian_.A * kDt;
  std::optional<franka::Vector2> elbow;
  if (elbow_given_) {
    const double rate = cartesian_.elbow[1] + cartesian_.elbow[2] * kDt;
    elbow = {cartesian_.elbow[0] + rate * kDt, cartesian_.elbow_sign};
  }
  return StepPose(Moved(cartesian_.X, V * kDt), V, elbow);
}

MaybeError FciReference::StepJoints(const Joints& q, const Joints& dq) {
  const Joints ddq = (dq - joints_.dq) / kDt;
  const Joints dddq = (ddq - joints_.ddq) / kDt;
  // Checks where the joint could stop at the earliest, so that a stop does not end outside its range.
  const Joints q_rest = q + dq.cwiseProduct(dq.cwiseAbs()).cwiseQuotient(2.0 * fci_limits::kDdq);
  if (!q_rest.allFinite() || ((q_rest.cwiseMax(q) - fci_limits::kQMax).array() > 0.0).any() ||
      ((fci_limits::kQMin - q_rest.cwiseMin(q)).array() > 0.0).any()) {
    return Error::kJointPositionLimitsOfMotion;
  }
  if (Beyond(dq, fci_limits::kDq)) {
    return Error::kJointVelocityLimitsOfMotion;
  }
  if (Beyond(ddq, fci_limits::kDdq)) {
    return Error::kJointVelocityDiscontinuity;
  }
  if (Beyond(dddq, fci_limits::kDddq)) {
    return Error::kJointAccelerationDiscontinuity;
  }
  joints_ = {q, dq, ddq};
  return std::nullopt;
}

MaybeError FciReference::StepPose(const Eigen::Isometry3d& X_next, const Twist& V,
                                  const std::optional<franka::Vector2>& elbow) {
  const auto beyond = [](const Twist& value, double translation, double rotation) {
    return !value.allFinite() || value.head<3>().norm() > fci_limits::kRounding * translation ||
           value.tail<3>().norm() > fci_limits::kRounding * rotation;
  };
  using fci_limits::kRotation;
  using fci_limits::kTranslation;
  const Twist A = (V - cartesian_.V) / kDt;
  const Twist jerk = (A - cartesian_.A) / kDt;
  if (beyond(V, kTranslation.velocity, kRotation.velocity)) {
    return Error::kCartesianVelocityLimits;
  }
  if (beyond(A, kTranslation.acceleration, kRotation.acceleration)) {
    return Error::kCartesianVelocityDiscontinuity;
  }
  if (beyond(jerk, kTranslation.jerk, kRotation.jerk)) {
    return Error::kCartesianAccelerationDiscontinuity;
  }
  if (elbow) {
    if ((*elbow)[1] * cartesian_.elbow_sign < 0.0) {
      return Error::kCartesianElbowSignInconsistent;
    }
    const double rate = ((*elbow)[0] - cartesian_.elbow[0]) / kDt;
    const double change = (rate - cartesian_.elbow[1]) / kDt;
    using fci_limits::kElbow;
    if (!(std::fabs(rate) <= fci_limits::kRounding * kElbow.velocity) ||
        !(std::fabs(change) <= fci_limits::kRounding * kElbow.acceleration) ||
        !(std::fabs(change - cartesian_.elbow[2]) / kDt <= fci_limits::kRounding * kElbow.jerk)) {
      return Error::kCartesianElbowLimit;
    }
  }

  const std::optional<Joints> q = Solve(X_next, elbow ? std::optional((*elbow)[0]) : std::nullopt);
  if (!q) {
    return Error::kCartesianJointVelocityLimits;  // no solution near the present joints
  }
  if (const MaybeError error = StepJoints(*q, (*q - joints_.q) / kDt)) {
    switch (*error) {
      case Error::kJointPositionLimitsOfMotion: return Error::kCartesianJointPositionLimits;
      case Error::kJointVelocityLimitsOfMotion: return Error::kCartesianJointVelocityLimits;
      case Error::kJointVelocityDiscontinuity: return Error::kCartesianJointVelocityDiscontinuity;
      default: return Error::kCartesianJointAccelerationDiscontinuity;
    }
  }
  const double rate = (joints_.q[2] - cartesian_.elbow[0]) / kDt;
  cartesian_.elbow = {joints_.q[2], rate, (rate - cartesian_.elbow[1]) / kDt};
  cartesian_.X = X_next;
  cartesian_.V = V;
  cartesian_.A = A;
  return std::nullopt;
}

// Joint positions near the present ones that place the end effector at `X_goal`, and joint 3 at `elbow` if
// given; otherwise by minimum-norm steps. Newton's method.
std::optional<Joints> FciReference::Solve(const Eigen::Isometry3d& X_goal,
                                          const std::optional<double>& elbow) const {
  Eigen::VectorXd q = joints_.q;
  Jacobian J;
  for (int k = 0; k < kMostIterations; ++k) {
    const Eigen::Isometry3d X_BE = chain_.TipPose(q, J);
    const Eigen::Isometry3d X = X_BE * F_T_EE_;
    // Moves J to the origin of EE.
    const Eigen::Vector3d arm = X.translation() - X_BE.translation();
    for (Eigen::Index i = 0; i < J.cols(); ++i) {
      J.col(i).head<3>() += J.col(i).tail<3>().cross(arm);
    }
    const Twist left = Between(X, X_goal);
    const double elbow_left = elbow ? *elbow - q[2] : 0.0;
    if (left.cwiseAbs().maxCoeff() < kSolved && std::fabs(elbow_left) < kSolved) {
      return Joints(q);
    }
    if (elbow) {
      Eigen::Matrix<double, 7, 7> A;
      A << J, Joints::Unit(2).transpose();
      Joints b;
      b << left, elbow_left;
      q += A.colPivHouseholderQr().solve(b);
    } else {
      const Eigen::Matrix<double, 6, 6> JJt = J * J.transpose();
      q += J.transpose() * JJt.ldlt().solve(left);
    }
    if (!q.allFinite() || (q - joints_.q).cwiseAbs().maxCoeff() > 1.0) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace fovea::sim
