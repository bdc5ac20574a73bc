// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/target_feature.hpp"

#include <algorithm>

#include "firmware/core/features/hold_orientation.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::features {
namespace {

// TraitsOf uses the kind as index. A turn that leaves a plate's look maps its corners onto each other.
static_assert([] {
  for (std::size_t i = 0; i < kTargets.size(); ++i) {
    const TargetTraits& target = kTargets[i];
    const bool is_plate = target.body == TargetBody::kPlate;
    if (static_cast<std::size_t>(target.kind) != i || target.turns < 1 ||
        (is_plate ? target.num_corners % target.turns != 0 : target.turns != 1) ||
        (target.num_corners > 0) != is_plate || target.num_corners > Polygon::kMost) {
      return false;
    }
  }
  return true;
}());

// Copies the measurement's covariance into `cov` [dim x dim].
template <typename Matrix>
void TakeCovariance(const hal::FeatureMeasurement& measurement, Matrix& cov) noexcept {
  for (int row = 0; row < measurement.dim; ++row) {
    for (int col = 0; col < measurement.dim; ++col) {
      cov(row, col) = measurement.cov_s[static_cast<std::size_t>(row * hal::kMaxFeatureDim + col)];
    }
  }
}

}  // namespace

bool TargetFeature::IsListed() const noexcept {
  const TargetTraits& traits = TraitsOf(target);
  bool listed = std::find(traits.forms.begin(), traits.forms.end(), form) != traits.forms.end();
  if (SeesOrientation() && TakesWholePose(form)) {
    listed = listed && corners.num_corners == traits.num_corners;
  }
  return listed && Dim() <= kMaxDim;
}

int TargetFeature::Dim() const noexcept {
  const int held = hold_orientation ? HoldOrientation::kDim : 0;
  switch (form) {
    case FeatureForm::kSphere: return SphereFeature::kDim + held;
    case FeatureForm::kCircle: return CircleFeature::kDim + held;
    case FeatureForm::kCorners: return 2 * corners.num_corners + held;
    case FeatureForm::kSide:
    case FeatureForm::kCornerSide: return SquareSideFeature::kDim + held;
    case FeatureForm::kPose:
    case FeatureForm::kHybrid: return (SeesOrientation() ? 6 : 3) + held;
  }
  return 0;
}

TargetOutline TargetFeature::Outline() const noexcept {
  TargetOutline outline;
  if (SeesOrientation()) {
    outline.num_points = corners.num_corners;
    outline.p_OP = corners.corners;
  } else {
    outline.p_OP[0] = model::Vec3::Zero();
    outline.radius = radius;
  }
  return outline;
}

bool TargetFeature::Compute(const TargetInCamera& seen, FeatureState& state) const noexcept {
  const model::Pose X_CO_star{R_CO_star, p_CO_C_star};
  switch (form) {
    case FeatureForm::kSphere:
      return SphereFeature{radius, p_CO_C_star}.Compute(seen.X_CO.p, seen.v_BO_C, state);
    case FeatureForm::kCircle: return CircleFeature{2.0 * radius, 1.0, p_CO_C_star}.Compute(seen, state);
    case FeatureForm::kCorners: return ComputeCorners(corners, seen, X_CO_star, state);
    case FeatureForm::kPose: return PoseFeature{X_CO_star, SeesOrientation()}.Compute(seen, state);
    case FeatureForm::kHybrid: return HybridFeature{X_CO_star, SeesOrientation()}.Compute(seen, state);
    case FeatureForm::kSide:
    case FeatureForm::kCornerSide: {
      const auto anchor = form == FeatureForm::kSide ? SquareSideFeature::Anchor::kCentre
                                                     : SquareSideFeature::Anchor::kFirstCorner;
      return SquareSideFeature{side, anchor, X_CO_star}.Compute(seen, state);
    }
  }
  return false;
}

bool TargetFeature::ComputeAtGoal(FeatureState& state) const noexcept {
  return Compute({{R_CO_star, p_CO_C_star}, model::Vec3::Zero(), model::Vec3::Zero()}, state);
}

bool TargetFeature::Lift(const hal::FeatureMeasurement& measurement, LiftedTarget& lifted) const noexcept {
  if (SeesOrientation() || !measurement.found || measurement.kind != target || measurement.dim != 3) {
    return false;
  }
  const model::Vec3 s(measurement.s[0], measurement.s[1], measurement.s[2]);
  model::Mat3 cov_s;
  TakeCovariance(measurement, cov_s);
  if (TraitsOf(target).body == TargetBody::kDisc) {
    return CircleFeature{2.0 * radius, 1.0, p_CO_C_star}.Lift(s, cov_s, lifted.p_CO_C, lifted.cov_p);
  }
  return SphereFeature{radius, p_CO_C_star}.Lift(s, cov_s, lifted.p_CO_C, lifted.cov_p);
}

bool TargetFeature::TakeCorners(const hal::FeatureMeasurement& measurement,
                                SeenCorners& seen) const noexcept {
  const int n = corners.num_corners;
  if (!SeesOrientation() || !measurement.found || measurement.kind != target || measurement.dim != 2 * n) {
    return false;
  }
  seen.xy.resize(2 * n);
  for (int i = 0; i < 2 * n; ++i) {
    seen.xy[i] = measurement.s[static_cast<std::size_t>(i)];
  }
  seen.cov.resize(2 * n, 2 * n);
  TakeCovariance(measurement, seen.cov);
  if (!seen.xy.allFinite() || !seen.cov.allFinite()) {
    return false;
  }
  seen.num_branches = 0;
  for (int i = 0; i < measurement.num_poses && i < hal::kMaxPoses; ++i) {
    const hal::FlatPose& pose = measurement.poses[static_cast<std::size_t>(i)];
    SeenCorners::Branch& branch = seen.branches[static_cast<std::size_t>(seen.num_branches)];
    branch.X_CO.p = {pose.p_CO_C[0], pose.p_CO_C[1], pose.p_CO_C[2]};
    branch.first = pose.first;
    if (branch.X_CO.p.allFinite() && branch.X_CO.p.z() >= kMinDepth && pose.first >= 0 && pose.first < n &&
        model::RotationOfQuaternion(pose.q_CO, branch.X_CO.R)) {
      ++seen.num_branches;
    }
  }
  return true;
}

}  // namespace fovea::features
