// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/sampler.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "firmware/core/model/rotation.hpp"
#include "tools/fovea/atlas/way.hpp"

namespace fovea::atlas {
namespace {

using model::Mat3;
using model::Pose;
using model::Vec3;
using model::VecN;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kDepthLeast = 0.25;  // [m]
constexpr double kDepthMost = 0.90;
constexpr double kTiltMostDeg = 45.0;
constexpr double kJointMargin = 5.0 * kRadPerDeg;
constexpr double kRangeOnTheWay = 0.06;  // a path may use this much more of a joint's range at each end [rad]
constexpr int kMostDraws = 1'000'000;
constexpr double kNear = 0.5;      // [rad]
constexpr int kNearDescents = 16;  // from postures near the start; kFarDescents: from anywhere
constexpr int kFarDescents = 24;
constexpr int kDescentSteps = 120;

double Uniform(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11U) * 0x1p-53;
}

double Rounded(double value, double step) { return std::round(value / step) * step; }

// Roll, pitch, yaw about fixed axes, as in a scenario.
std::array<double, 3> RollPitchYawDeg(const Mat3& R) {
  return {std::atan2(R(2, 1), R(2, 2)) / kRadPerDeg,
          std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))) / kRadPerDeg,
          std::atan2(R(1, 0), R(0, 0)) / kRadPerDeg};
}

Mat3 RotationOfRpyDeg(const std::array<double, 3>& rpy_deg) {
  return model::RotationOf({0.0, 0.0, rpy_deg[2] * kRadPerDeg}) *
         model::RotationOf({0.0, rpy_deg[1] * kRadPerDeg, 0.0}) *
         model::RotationOf({rpy_deg[0] * kRadPerDeg, 0.0, 0.0});
}

}  // namespace

Sampler::Sampler(const model::ArmModel& arm, const features::TargetFeature& feature)
    : arm_(arm), feature_(feature), checks_(arm, feature) {
  q_least_.resize(arm_.num_joints);
  q_most_.resize(arm_.num_joints);
  for (int i = 0; i < arm_.num_joints; ++i) {
    const model::Joint& joint = arm_.joints[static_cast<std::size_t>(i)];
    q_least_[i] = joint.q_min + kJointMargin;
    q_most_[i] = joint.q_max - kJointMargin;
  }
}

VecN Sampler::DrawPosture(std::mt19937_64& engine) const {
  constexpr double kStep = 1e-4;
  VecN q(arm_.num_joints);
  for (int i = 0; i < q.size(); ++i) {
    q[i] = Rounded(Uniform(engine, q_least_[i] + kStep, q_most_[i] - kStep), kStep);
  }
  return q;
}

// X_CO of a target at a random place in the picture.
Pose Sampler::DrawTarget(std::mt19937_64& engine) const {
  const double u = Uniform(engine, 0.0, kWidthPx - 1.0);
  const double v = Uniform(engine, 0.0, kHeightPx - 1.0);
  const double depth = Uniform(engine, kDepthLeast, kDepthMost);
  const double tilt = kRadPerDeg * Uniform(engine, 0.0, kTiltMostDeg);
  const double about = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  const double turn = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  Pose X_CO;
  X_CO.p =
      depth * Vec3((u - 0.5 * (kWidthPx - 1.0)) / FocalPx(), (v - 0.5 * (kHeightPx - 1.0)) / FocalPx(), 1.0);
  X_CO.R = model::RotationOf({tilt * std::cos(about), tilt * std::sin(about), 0.0}) *
           model::RotationOf({0.0, 0.0, turn});
  return X_CO;
}

// The goal's orientation. If several look alike, the nearest one.
Mat3 Sampler::NearestGoal(const Mat3& R_CO) const {
  const int turns = features::TraitsOf(feature_.target).turns;
  Mat3 nearest = feature_.R_CO_star;
  for (int turn = 1; turn < turns; ++turn) {
    const Mat3 other =
        feature_.R_CO_star * model::RotationOf({0.0, 0.0, 2.0 * std::numbers::pi * turn / turns});
    if ((other.transpose() * R_CO).trace() > (nearest.transpose() * R_CO).trace()) {
      nearest = other;
    }
  }
  return nearest;
}

// Gauss-Newton on the target's pose in the camera: with V the camera's twist, dp_CO/dt = -v + [p]x w and the
// orientation turns by -w. A joint at the end of its range stays there if the step would take it further.
std::optional<VecN> Sampler::DescentTo(const VecN& q_start, const Pose& X_BO) const {
  constexpr double kStepMost = 0.2;  // [rad]
  constexpr double kDamping = 1e-6;
  constexpr double kReached = 1e-5;  // [m, rad]
  const int rows = feature_.SeesOrientation() ? 6 : 3;
  VecN q = q_start;
  for (int step = 0; step < kDescentSteps; ++step) {
    const StartPosture posture = checks_.At(q);
    const Pose X_CO = posture.X_BC.Inverse() * X_BO;
    model::Vec6 off = model::Vec6::Zero();
    off.head<3>() = X_CO.p - feature_.p_CO_C_star;
    if (rows == 6) {
      off.tail<3>() = model::RotationVector(X_CO.R * NearestGoal(X_CO.R).transpose());
    }
    if (off.norm() < kReached) {
      const bool stands = checks_.InsideBarrier(posture) && checks_.AboveTable(posture) &&
                          !checks_.ArmInTheWay(posture, X_BO) && !checks_.BenchInTheWay(posture, X_BO);
      return stands ? std::optional<VecN>(q) : std::nullopt;
    }
    model::Mat6N J_C;
    model::ComputeJacobian(arm_, posture.poses, checks_.camera(), J_C);
    model::Mat6N J(6, arm_.num_joints);
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

// If the target is not completely in the picture: a Gauss-Newton step that moves its centre a third of the
// way to the picture's centre.
VecN Sampler::PulledIntoView(const VecN& q, const Pose& X_BO) const {
  constexpr double kShare = 1.0 / 3.0;
  const StartPosture posture = checks_.At(q);
  const Pose X_CO = posture.X_BC.Inverse() * X_BO;
  if (!checks_.OutOfViewOnTheWay(X_CO)) {
    return q;
  }
  model::Mat6N J_C;
  model::ComputeJacobian(arm_, posture.poses, checks_.camera(), J_C);
  const Eigen::MatrixXd dp = -J_C.topRows<3>() + model::CrossMatrix(X_CO.p) * J_C.bottomRows<3>();
  const double x = X_CO.p.x() / X_CO.p.z();
  const double y = X_CO.p.y() / X_CO.p.z();
  Eigen::MatrixXd A(2, q.size());
  A.row(0) = (dp.row(0) - x * dp.row(2)) / X_CO.p.z();
  A.row(1) = (dp.row(1) - y * dp.row(2)) / X_CO.p.z();
  return q - A.transpose() * (A * A.transpose()).ldlt().solve(kShare * Eigen::Vector2d(x, y));
}

std::vector<VecN> Sampler::FindGoals(const VecN& q, const Pose& X_BO, std::mt19937_64& engine) const {
  std::vector<VecN> goals;
  const auto descend = [&](const VecN& from) {
    if (const std::optional<VecN> goal = DescentTo(from, X_BO)) {
      goals.push_back(*goal);
    }
  };
  descend(q);
  for (int i = 0; i < kNearDescents; ++i) {
    const VecN near = q.unaryExpr([&](double joint) { return joint + Uniform(engine, -kNear, kNear); });
    descend(near.cwiseMax(q_least_).cwiseMin(q_most_));
  }
  for (int i = 0; i < kFarDescents; ++i) {
    descend(DrawPosture(engine));
  }
  return goals;
}

bool Sampler::WayLeadsOn(const VecN& q, const Pose& X_BO, const std::vector<VecN>& goals,
                         std::uint64_t seed) const {
  WayProblem problem;
  problem.least = q_least_.array() - kRangeOnTheWay;
  problem.most = q_most_.array() + kRangeOnTheWay;
  problem.is_allowed = [&](const VecN& at) { return checks_.OnTheWay(checks_.At(at), X_BO); };
  problem.pull = [&](const VecN& at) { return PulledIntoView(at, X_BO); };
  return WayExists(problem, q, goals, seed);
}

double Sampler::ErrorPx(const Pose& X_CO) const {
  const bool turned = feature_.SeesOrientation();
  const Pose goal{turned ? NearestGoal(X_CO.R) : Mat3::Identity(), feature_.p_CO_C_star};
  const int points = turned ? feature_.corners.num_corners : 1;
  double sum2 = 0.0;
  for (int i = 0; i < points; ++i) {
    const Vec3 p_OP = turned ? feature_.corners.corners[static_cast<std::size_t>(i)] : Vec3(Vec3::Zero());
    const Vec3 p = X_CO * p_OP;
    const Vec3 p_star = goal * p_OP;
    sum2 += std::pow(U(p) - U(p_star), 2) + std::pow(V(p) - V(p_star), 2);
  }
  return std::sqrt(sum2 / points);
}

Start Sampler::Draw(std::uint64_t seed, int index) const {
  std::seed_seq mixed{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                      static_cast<std::uint32_t>(index)};
  std::mt19937_64 engine(mixed);
  Start start;
  const auto refuse = [&](Rejection reason) { ++start.rejections[static_cast<std::size_t>(reason)]; };
  for (int draw = 0; draw < kMostDraws; ++draw) {
    const StartPosture posture = checks_.At(DrawPosture(engine));
    const Pose drawn = DrawTarget(engine);
    if (!checks_.InsideBarrier(posture)) {
      refuse(Rejection::kStartOutsideBarrier);
      continue;
    }
    if (!checks_.AboveTable(posture)) {
      refuse(Rejection::kStartBelowTable);
      continue;
    }
    // Rounded as in the settings of the run.
    Pose X_BO = posture.X_BC * drawn;
    X_BO.p = X_BO.p.unaryExpr([](double x) { return Rounded(x, 1e-4); });
    start.rpy_deg = RollPitchYawDeg(X_BO.R);
    for (double& angle : start.rpy_deg) {
      angle = Rounded(angle, 0.01);
    }
    X_BO.R = RotationOfRpyDeg(start.rpy_deg);
    const Pose X_CO = posture.X_BC.Inverse() * X_BO;
    if (!checks_.InPicture(X_CO)) {
      refuse(Rejection::kTargetNearEdge);
      continue;
    }
    if (!checks_.TargetAboveTable(X_BO)) {
      refuse(Rejection::kTargetBelowTable);
      continue;
    }
    if (checks_.ArmInTheWay(posture, X_BO)) {
      refuse(Rejection::kArmInTheWay);
      continue;
    }
    if (checks_.BenchInTheWay(posture, X_BO)) {
      refuse(Rejection::kThingInTheWay);
      continue;
    }
    const std::vector<VecN> goals = FindGoals(posture.q, X_BO, engine);
    if (goals.empty()) {
      refuse(Rejection::kNoGoalPosture);
      continue;
    }
    if (!WayLeadsOn(posture.q, X_BO, goals, engine())) {
      refuse(Rejection::kNoWay);
      continue;
    }
    start.q.assign(posture.q.begin(), posture.q.end());
    start.p_BO = X_BO.p;
    start.run_seed = static_cast<std::uint32_t>(engine() >> 33U);
    start.u_px = U(X_CO.p);
    start.v_px = V(X_CO.p);
    start.depth = X_CO.p.z();
    start.tilt_deg = std::acos(std::clamp(X_CO.R(2, 2), -1.0, 1.0)) / kRadPerDeg;
    start.error_px = ErrorPx(X_CO);
    return start;
  }
  throw std::runtime_error("no feasible start in a million draws");
}

}  // namespace fovea::atlas
