// SPDX-License-Identifier: Apache-2.0
// The target's true error to its goal.
#pragma once

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "sim/camera/lens.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

// The target's goal, as far as its feature defines it.
struct TargetGoal {
  Eigen::Vector3d p_CO_C_star = Eigen::Vector3d::Zero();  // [m]
  std::optional<Eigen::Matrix3d> R_CO_star;  // none if the feature does not control the full orientation
  int turns = 1;  // number of indistinguishable orientations about O's z, e.g. 4 for a square
  std::vector<Eigen::Vector3d> points{Eigen::Vector3d::Zero()};  // judged in the image, in O [m]
};

inline TargetGoal GoalOf(const features::TargetFeature& feature) {
  TargetGoal goal;
  goal.p_CO_C_star = feature.p_CO_C_star;
  if (feature.SeesOrientation() && features::TakesWholePose(feature.form)) {
    goal.R_CO_star = feature.R_CO_star;
    goal.turns = features::TraitsOf(feature.target).turns;
    const auto corners = feature.corners.corners.begin();
    goal.points.assign(corners, corners + feature.corners.num_corners);
  }
  return goal;
}

// The true camera and target, and what the servo believes of them. The servo's goal in the picture follows
// from its belief.
struct JudgedEye {
  Pinhole pinhole;
  Lens lens;
  Pinhole believed_pinhole;
  Lens believed_lens;
  double target_scale = 1.0;  // true size over the believed one
  bool differs = false;       // the cameras are not the same
  // False: no place of the target gives exactly the goal's picture, or the truth is not as believed and the
  // picture of the target's corners tells all of its pose: then the picture alone is judged.
  bool judges_metres = true;

  // True if the goal's picture is not seen of a target at the goal, but of one elsewhere.
  [[nodiscard]] bool MovesGoal() const { return differs || target_scale != 1.0; }
};

inline JudgedEye JudgedEyeOf(const RunDescription& about) {
  const auto is_true = [&](Quantity quantity) {
    return std::none_of(about.truth.begin(), about.truth.end(),
                        [quantity](const TrueValue& value) { return value.quantity == quantity; });
  };
  const bool similar = is_true(Quantity::kAspect) && is_true(Quantity::kLens);
  const bool same = similar && is_true(Quantity::kFocalLength) && is_true(Quantity::kPrincipalPoint);
  const bool is_judged_by_corners = GoalOf(about.servo.feature).R_CO_star && !about.truth.empty();
  return {about.eye.pinhole,
          about.eye.lens,
          about.pinhole,
          about.lens,
          about.target_scale,
          !same,
          similar && !is_judged_by_corners};
}

// Where the target must be for its true picture to be the goal's, `p_star`, of the believed camera and
// target; both in C [m]. A longer camera and a larger target are further away. Only focal length, principal
// point and size may differ.
inline Eigen::Vector3d TrueGoal(const JudgedEye& eye, const Eigen::Vector3d& p_star) {
  const Pinhole& believed = eye.believed_pinhole;
  const double z = p_star.z() * eye.target_scale * eye.pinhole.f_px / believed.f_px;
  if (!eye.MovesGoal()) {
    return p_star;
  }
  return {z * (believed.U(p_star) - eye.pinhole.c_u_px) / eye.pinhole.f_px,
          z * (believed.V(p_star) - eye.pinhole.c_v_px) / eye.pinhole.FocalV(), z};
}

// Distance in the picture between the true image of `p` and the goal's, `p_star` [px]; both in C. With equal
// cameras, as an ideal lens draws them.
inline Eigen::Vector2d ImageError(const JudgedEye& eye, const Eigen::Vector3d& p,
                                  const Eigen::Vector3d& p_star) {
  const auto pixel = [](const Pinhole& pinhole, const Eigen::Vector3d& p_C) {
    return Eigen::Vector2d(pinhole.U(p_C), pinhole.V(p_C));
  };
  if (!eye.differs) {
    return pixel(eye.pinhole, p) - pixel(eye.pinhole, p_star);
  }
  const auto through = [](const Lens& lens, const Eigen::Vector3d& p_C) {
    return Distort(lens, p_C.head<2>() / p_C.z()).homogeneous().eval();
  };
  return pixel(eye.pinhole, through(eye.lens, p)) -
         pixel(eye.believed_pinhole, through(eye.believed_lens, p_star));
}

struct TargetError {
  // rms over the goal's points; infinite if one of them is behind the camera.
  double error_px = std::numeric_limits<double>::infinity();
  Eigen::Vector3d error_C = Eigen::Vector3d::Zero();  // goal minus truth, in axes of C [m]
  double judged_m = 0.0;                              // distance to TrueGoal
  std::optional<double> error_rad;                    // of the orientation, if the goal has one
};

inline TargetError ErrorOf(const Truth& truth, const JudgedEye& eye, const TargetGoal& goal) {
  const Eigen::Isometry3d X_CB = truth.X_BC.inverse();
  const Eigen::Vector3d p_CO_C = X_CB * truth.p_BO;
  Eigen::Matrix3d R_CO = X_CB.linear() * truth.R_BO;
  TargetError error;
  error.error_C = goal.p_CO_C_star - p_CO_C;
  error.judged_m = (TrueGoal(eye, goal.p_CO_C_star) - p_CO_C).norm();
  if (goal.R_CO_star) {
    const Eigen::Matrix3d R_CO_given = R_CO;
    for (int turn = 0; turn < goal.turns; ++turn) {
      const double angle = 2.0 * std::numbers::pi * turn / goal.turns;
      const Eigen::Matrix3d R_CO_turned =
          R_CO_given * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      const double off =
          Eigen::AngleAxisd(Eigen::Matrix3d(*goal.R_CO_star * R_CO_turned.transpose())).angle();
      if (!error.error_rad || off < *error.error_rad) {
        error.error_rad = off;
        R_CO = R_CO_turned;
      }
    }
  }
  double sum2 = 0.0;
  for (const Eigen::Vector3d& p_OP : goal.points) {
    const Eigen::Vector3d p = p_CO_C + R_CO * (eye.target_scale * p_OP);
    const Eigen::Vector3d p_star =
        goal.p_CO_C_star + (goal.R_CO_star ? Eigen::Vector3d(*goal.R_CO_star * p_OP) : p_OP);
    if (!(p.z() > 0.0)) {
      return error;
    }
    sum2 += ImageError(eye, p, p_star).squaredNorm();
  }
  error.error_px = std::sqrt(sum2 / static_cast<double>(goal.points.size()));
  return error;
}

}  // namespace fovea::sim
