// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/eye_model.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/rotation.hpp"
#include "firmware/core/model/twist.hpp"
#include "firmware/host/beliefs/refocus.hpp"

namespace fovea::beliefs {
namespace {

using model::Mat3;
using model::Vec3;

// The residual of a measurement, and its derivatives.
struct Difference {
  Eigen::VectorXd residual;
  Eigen::MatrixXd cov;
  Eigen::MatrixXd
      by_point;  // of the residual, by p_CO_C of each point of the target, side by side [dim x 3n]
  Eigen::VectorXd by_focal;
  Eigen::VectorXd by_size;
};

bool ComparePlace(const features::TargetFeature& feature, const hal::FeatureMeasurement& m,
                  const EyeState& state, const Vec3& p_CO_C, Difference& difference) {
  features::LiftedTarget lifted;
  if (!feature.Lift(m, lifted)) {
    return false;
  }
  Vec3 place;  // of a target of the believed size
  Vec3 by_focal;
  if (m.kind == hal::FeatureKind::kSphere) {
    if (!RefocusSphere(lifted.p_CO_C / feature.radius, state.focal, place, by_focal)) {
      return false;
    }
    place *= feature.radius;
    by_focal *= feature.radius;
  } else {
    place = lifted.p_CO_C + Vec3(0.0, 0.0, state.focal * lifted.p_CO_C.z());
    by_focal = Vec3(0.0, 0.0, lifted.p_CO_C.z());
  }
  difference.residual = (1.0 + state.size) * place - p_CO_C;
  difference.by_point = -Mat3::Identity();
  difference.by_focal = (1.0 + state.size) * by_focal;
  difference.by_size = place;
  difference.cov = lifted.cov_p;
  return true;
}

bool CompareCorners(const features::TargetFeature& feature, const hal::FeatureMeasurement& m, int turn,
                    const EyeState& state, const model::Pose& X_CO, Difference& difference) {
  constexpr double kMinDepth = 1e-3;
  features::SeenCorners seen;
  if (!feature.TakeCorners(m, seen)) {
    return false;
  }
  const int n = feature.corners.num_corners;
  difference.residual.resize(2 * n);
  difference.by_point = Eigen::MatrixXd::Zero(2 * n, 3 * n);
  difference.by_focal.resize(2 * n);
  difference.by_size.resize(2 * n);
  difference.cov = seen.cov;
  for (int i = 0; i < n; ++i) {
    const int corner = (i - turn + n) % n;  // of O
    const Vec3 p_OP = feature.corners.corners[static_cast<std::size_t>(corner)];
    const Vec3 p = X_CO * ((1.0 + state.size) * p_OP);
    if (!(p.z() > kMinDepth)) {
      return false;
    }
    Eigen::Matrix<double, 2, 3> by_p;
    by_p << 1.0 / p.z(), 0.0, -p.x() / (p.z() * p.z()), 0.0, 1.0 / p.z(), -p.y() / (p.z() * p.z());
    const Eigen::Vector2d measured = seen.xy.segment<2>(2 * i) / (1.0 + state.focal);
    difference.residual.segment<2>(2 * i) = measured - p.head<2>() / p.z();
    difference.by_point.block<2, 3>(2 * i, 3 * i) = -by_p;
    difference.by_focal.segment<2>(2 * i) = -measured / (1.0 + state.focal);
    difference.by_size.segment<2>(2 * i) = -by_p * (X_CO.R * p_OP);
  }
  return true;
}

// The points of the target that are seen, in axes of C, as the residual's derivatives have them.
std::vector<Vec3> PointsOf(const features::TargetFeature& feature, int turn, const EyeState& state,
                           const model::Pose& X_CO) {
  std::vector<Vec3> points;
  if (!feature.SeesOrientation()) {
    return {X_CO.p};
  }
  const int n = feature.corners.num_corners;
  for (int i = 0; i < n; ++i) {
    points.push_back(
        X_CO * ((1.0 + state.size) * feature.corners.corners[static_cast<std::size_t>((i - turn + n) % n)]));
  }
  return points;
}

}  // namespace

EyeState Believed(const config::ServoConfig& config, const model::Pose& X_BO) {
  EyeState state;
  state.X_EC = config.X_EC;
  state.zeros.setZero(config.arm.num_joints);
  state.X_BO = X_BO;
  return state;
}

void Apply(const EyeLayout& layout, const Eigen::VectorXd& change, EyeState& state) {
  state.late += change[EyeLayout::kLate];
  state.X_EC = state.X_EC * model::Pose{model::RotationOf(change.segment<3>(EyeLayout::kTurn)),
                                        change.segment<3>(EyeLayout::kShift)};
  state.focal += change[EyeLayout::kFocal];
  state.size += change[EyeLayout::kSize];
  state.zeros.segment(1, layout.zeros) += change.segment(EyeLayout::kZeros, layout.zeros);
  const auto target = change.segment(layout.target(), layout.size() - layout.target());
  state.X_BO =
      state.X_BO * model::Pose{layout.is_flat ? model::RotationOf(target.tail<3>()) : Mat3(Mat3::Identity()),
                               target.head<3>()};
}

bool PoseOfEye(const config::ServoConfig& config, const JointTrack& track, const EyeState& state,
               std::int64_t stamp_ns, EyePose& pose) {
  JointMotion motion;
  if (!track.At(stamp_ns - std::llround(1e9 * state.late), motion)) {
    return false;
  }
  model::ArmPoses poses;
  model::ComputePoses(config.arm, motion.q - state.zeros, poses);
  pose.X_BC = poses.X_BE * state.X_EC;
  model::ComputeJacobian(config.arm, poses, state.X_EC, pose.J_C);
  pose.V_BC_C = pose.J_C * motion.dq;
  return true;
}

bool Compare(const config::ServoConfig& config, const JointTrack& track,
             const hal::FeatureMeasurement& measurement, int turn, const EyeState& state,
             Equations& equations) {
  EyePose eye;
  if (!PoseOfEye(config, track, state, measurement.stamp_ns, eye)) {
    return false;
  }
  const EyeLayout layout(config);
  const model::Pose X_CO = eye.X_BC.Inverse() * state.X_BO;
  Difference difference;
  const bool is_seen = layout.is_flat
                           ? CompareCorners(config.feature, measurement, turn, state, X_CO, difference)
                           : ComparePlace(config.feature, measurement, state, X_CO.p, difference);
  if (!is_seen) {
    return false;
  }
  const Eigen::LLT<Eigen::MatrixXd> whiten(difference.cov);
  if (whiten.info() != Eigen::Success) {
    return false;
  }
  // A twist of C [v; w] moves a point at p_CO_C by -v - w x p_CO_C; one of O moves it by v + w x p_OP,
  // turned.
  const std::vector<Vec3> points = PointsOf(config.feature, turn, state, X_CO);
  const auto rows = difference.residual.size();
  Eigen::MatrixXd by_twist(rows, 6);
  by_twist.setZero();
  Eigen::MatrixXd jacobian(rows, layout.size());
  jacobian.setZero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::MatrixXd by_point = difference.by_point.middleCols(3 * static_cast<Eigen::Index>(i), 3);
    by_twist.leftCols<3>() -= by_point;
    by_twist.rightCols<3>() += by_point * model::CrossMatrix(points[i]);
    jacobian.middleCols(layout.target(), 3) += by_point * X_CO.R;
    if (layout.is_flat) {
      const Vec3 p_OP = X_CO.Inverse() * points[i];
      jacobian.rightCols<3>() -= by_point * X_CO.R * model::CrossMatrix(p_OP);
    }
  }
  jacobian.col(EyeLayout::kLate) = -by_twist * eye.V_BC_C;
  jacobian.middleCols(EyeLayout::kShift, 6) = by_twist;
  jacobian.col(EyeLayout::kFocal) = difference.by_focal;
  jacobian.col(EyeLayout::kSize) = difference.by_size;
  jacobian.middleCols(EyeLayout::kZeros, layout.zeros) = -by_twist * eye.J_C.middleCols(1, layout.zeros);
  equations.residual = whiten.matrixL().solve(difference.residual);
  equations.jacobian = whiten.matrixL().solve(jacobian);
  return true;
}

}  // namespace fovea::beliefs
