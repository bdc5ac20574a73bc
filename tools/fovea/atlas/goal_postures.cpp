// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/goal_postures.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/core/model/rotation.hpp"

namespace fovea::atlas {
namespace {

using model::Mat3;
using model::Pose;
using model::Vec3;
using model::Vec6;
using model::VecN;

constexpr double kJointMargin = 5.0 * std::numbers::pi / 180.0;
constexpr double kNear = 0.5;  // [rad]
constexpr int kDescentSteps = 120;

// The target's position and orientation off `X_CO_star`.
Vec6 OffOf(const Pose& X_CO, const Pose& X_CO_star) {
  Vec6 off;
  off.head<3>() = X_CO.p - X_CO_star.p;
  off.tail<3>() = model::RotationVector(X_CO.R * X_CO_star.R.transpose());
  return off;
}

}  // namespace

GoalPostures::GoalPostures(const Scene& scene, Bounds bounds) : checks_(scene), bounds_(bounds) {
  const model::ArmModel& arm = scene.servo.arm;
  q_least_.resize(arm.num_joints);
  q_most_.resize(arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double margin = bounds == Bounds::kOfServo
                              ? scene.servo.guard.joint_position_margin
                              : std::min(kJointMargin, 0.25 * (joint.q_max - joint.q_min));
    q_least_[i] = joint.q_min + margin;
    q_most_[i] = joint.q_max - margin;
  }
}

VecN GoalPostures::DrawPosture(std::mt19937_64& engine) const {
  constexpr double kStep = 1e-4;
  VecN q(q_least_.size());
  for (int i = 0; i < q.size(); ++i) {
    q[i] = kStep * std::round(Uniform(engine, q_least_[i] + kStep, q_most_[i] - kStep) / kStep);
  }
  return q;
}

Mat3 GoalPostures::NearestGoal(const Mat3& R_CO) const {
  const features::TargetFeature& feature = checks_.scene().servo.feature;
  const int turns = features::TraitsOf(feature.target).turns;
  Mat3 nearest = feature.R_CO_star;
  for (int turn = 1; turn < turns; ++turn) {
    const Mat3 other =
        feature.R_CO_star * model::RotationOf({0.0, 0.0, 2.0 * std::numbers::pi * turn / turns});
    if ((other.transpose() * R_CO).trace() > (nearest.transpose() * R_CO).trace()) {
      nearest = other;
    }
  }
  return nearest;
}

// Gauss-Newton on the target's pose in the camera: with V the camera's twist, dp_CO/dt = -v + [p]x w and the
// orientation turns by -w. A joint at the end of its range stays there if the step would take it further.
std::optional<VecN> GoalPostures::Descend(const VecN& q_start, const Pose& X_BO, int rows,
                                          const Off& off_of) const {
  constexpr double kStepMost = 0.2;  // [rad]
  constexpr double kDamping = 1e-6;
  constexpr double kReached = 1e-5;  // [m, rad]
  const config::ServoConfig& servo = checks_.scene().servo;
  VecN q = q_start;
  for (int step = 0; step < kDescentSteps; ++step) {
    const StartPosture posture = checks_.At(q);
    const Pose X_CO = posture.X_BC.Inverse() * X_BO;
    const Vec6 off = off_of(X_CO);
    if (off.head(rows).norm() < kReached) {
      return q;
    }
    model::Mat6N J_C;
    model::ComputeJacobian(servo.arm, posture.poses, servo.X_EC, J_C);
    model::Mat6N J(6, q.size());
    J.topRows<3>() = -J_C.topRows<3>() + model::CrossMatrix(X_CO.p) * J_C.bottomRows<3>();
    J.bottomRows<3>() = -J_C.bottomRows<3>();
    Eigen::MatrixXd A = J.topRows(rows);
    Eigen::VectorXd dq = Eigen::VectorXd::Zero(q.size());
    for (int pass = 0; pass <= q.size(); ++pass) {
      Eigen::MatrixXd AAt = A * A.transpose();
      AAt.diagonal().array() += kDamping;
      dq = -A.transpose() * AAt.ldlt().solve(Eigen::VectorXd(off.head(rows)));
      const double largest = dq.cwiseAbs().maxCoeff();
      dq *= largest > kStepMost ? kStepMost / largest : 1.0;
      bool held = false;
      for (int i = 0; i < q.size(); ++i) {
        const bool at_end = (q[i] >= q_most_[i] && dq[i] > 0.0) || (q[i] <= q_least_[i] && dq[i] < 0.0);
        if (at_end) {
          A.col(i).setZero();
          held = true;
        }
      }
      if (!held) {
        break;
      }
    }
    q = (q + dq).cwiseMax(q_least_).cwiseMin(q_most_);
  }
  return std::nullopt;
}

std::optional<VecN> GoalPostures::DescendToGoal(const VecN& q, const Pose& X_BO) const {
  const features::TargetFeature& feature = checks_.scene().servo.feature;
  const std::optional<VecN> end = Descend(q, X_BO, feature.SeesOrientation() ? 6 : 3, [&](const Pose& X_CO) {
    return OffOf(X_CO, {NearestGoal(X_CO.R), feature.p_CO_C_star});
  });
  if (!end) {
    return std::nullopt;
  }
  const StartPosture posture = checks_.At(*end);
  const bool stands = bounds_ == Bounds::kOfServo ? checks_.StandsAtGoalByServo(posture, X_BO)
                                                  : checks_.StandsAtGoal(posture, X_BO);
  return stands ? end : std::nullopt;
}

std::vector<VecN> GoalPostures::Find(const VecN& q, const Pose& X_BO, const Descents& descents,
                                     std::mt19937_64& engine) const {
  std::vector<VecN> goals;
  const auto descend = [&](const VecN& from) {
    if (const std::optional<VecN> goal = DescendToGoal(from, X_BO)) {
      goals.push_back(*goal);
    }
  };
  descend(q);
  for (int i = 0; i < descents.near; ++i) {
    const VecN near = q.unaryExpr([&](double joint) { return joint + Uniform(engine, -kNear, kNear); });
    descend(near.cwiseMax(q_least_).cwiseMin(q_most_));
  }
  for (int i = 0; i < descents.far; ++i) {
    descend(DrawPosture(engine));
  }
  return goals;
}

// The descent moves the camera until a pose that is fixed in B is where it is in the wanted camera.
std::optional<VecN> GoalPostures::WithCameraAt(const Pose& X_BC,
                                               const std::function<bool(const VecN& q)>& is_allowed) const {
  constexpr int kDescents = 200;
  std::mt19937_64 engine;  // always the same postures
  VecN from = model::ToVector(checks_.scene().servo.arm.q_ready, static_cast<int>(q_least_.size()));
  for (int i = 0; i < kDescents; ++i) {
    const std::optional<VecN> q =
        Descend(from, X_BC, 6, [](const Pose& X_CD) { return OffOf(X_CD, Pose{}); });
    if (q && is_allowed(*q)) {
      return q;
    }
    from = DrawPosture(engine);
  }
  return std::nullopt;
}

VecN GoalPostures::PulledIntoView(const VecN& q, const Pose& X_BO) const {
  constexpr double kShare = 1.0 / 3.0;
  const config::ServoConfig& servo = checks_.scene().servo;
  const StartPosture posture = checks_.At(q);
  const Pose X_CO = posture.X_BC.Inverse() * X_BO;
  if (!checks_.OutOfViewOnTheWay(X_CO)) {
    return q;
  }
  model::Mat6N J_C;
  model::ComputeJacobian(servo.arm, posture.poses, servo.X_EC, J_C);
  const Eigen::MatrixXd dp = -J_C.topRows<3>() + model::CrossMatrix(X_CO.p) * J_C.bottomRows<3>();
  const double x = X_CO.p.x() / X_CO.p.z();
  const double y = X_CO.p.y() / X_CO.p.z();
  Eigen::MatrixXd A(2, q.size());
  A.row(0) = (dp.row(0) - x * dp.row(2)) / X_CO.p.z();
  A.row(1) = (dp.row(1) - y * dp.row(2)) / X_CO.p.z();
  return q - A.transpose() * (A * A.transpose()).ldlt().solve(kShare * Eigen::Vector2d(x, y));
}

}  // namespace fovea::atlas
