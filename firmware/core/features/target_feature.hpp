// SPDX-License-Identifier: Apache-2.0
// The features that the servo can steer by, for each target of target_traits.hpp.
//
//   target     feature     dim  controls                      file
//   sphere     sphere       3   x, y, z                       sphere.hpp
//              circle       3   x, y, z                       circle.hpp, the exercises' simple form
//              pose         3   x, y, z                       pose.hpp
//              hybrid       3   x, y, z                       hybrid.hpp
//   circle     circle       3   x, y, z                       circle.hpp; also pose, hybrid
//   square     corners      8   all six                       polygon.hpp, square.hpp
//              side         4   x, y, z, turn about the line of sight; from the centre
//              corner_side  4   the same from the first corner
//              pose         6   all six                       pose.hpp
//              hybrid       6   all six                       hybrid.hpp
//   triangle   pose         6   all six
//              hybrid       6   all six
//              corners      6   all six, up to four goals     polygon.hpp, triangle.hpp
//
// hold_orientation stacks three more entries below (hold_orientation.hpp).
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/features/circle.hpp"
#include "firmware/core/features/hybrid.hpp"
#include "firmware/core/features/polygon.hpp"
#include "firmware/core/features/pose.hpp"
#include "firmware/core/features/sphere.hpp"
#include "firmware/core/features/square.hpp"
#include "firmware/core/features/target_traits.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::features {

// A measurement of a sphere or circle, as a position.
struct LiftedTarget {
  model::Vec3 p_CO_C;  // [m]
  model::Mat3 cov_p;   // in axes of C [m^2]
};

// A measurement of a square or triangle: hal/feature.hpp.
struct SeenCorners {
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 2 * Polygon::kMost, 1>;
  using Covariance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                   2 * Polygon::kMost, 2 * Polygon::kMost>;
  struct Branch {
    model::Pose X_CO;
    int first = 0;
  };

  Vector xy;       // [2 n] in the normalised image
  Covariance cov;  // [2 n x 2 n]
  int num_branches = 0;
  std::array<Branch, hal::kMaxPoses> branches;
};

// The part of the target that must stay in the picture: its corners, or a ball about its centre.
struct TargetOutline {
  int num_points = 1;
  std::array<model::Vec3, Polygon::kMost> p_OP{};  // in O [m]
  double radius = 0.0;                             // about each [m]
};

struct TargetFeature {
  hal::FeatureKind target = hal::FeatureKind::kSphere;
  FeatureForm form = FeatureForm::kSphere;
  bool hold_orientation = false;  // servo.hold_orientation: keep the camera's orientation of Track's begin

  double radius = 0.04;                             // of sphere and circle [m]
  double side = 0.10;                               // of the square [m]
  Polygon corners;                                  // of square and triangle
  model::Vec3 p_CO_C_star{0.0, 0.0, 0.40};          // goal of the target's position, in C [m]
  model::Mat3 R_CO_star = model::Mat3::Identity();  // goal of its orientation

  [[nodiscard]] bool SeesOrientation() const noexcept { return TraitsOf(target).body == TargetBody::kPlate; }
  // True if `form` is a feature of `target`, and all stacked entries fit.
  [[nodiscard]] bool IsListed() const noexcept;
  [[nodiscard]] int Dim() const noexcept;
  [[nodiscard]] TargetOutline Outline() const noexcept;

  // s, s_star, L_s and the target's share for `seen`, without stacked entries. False, with `state` unchanged,
  // if the feature refuses. Real-time: yes.
  [[nodiscard]] bool Compute(const TargetInCamera& seen, FeatureState& state) const noexcept;

  // The same at the goal, with the target at rest. Real-time: yes.
  [[nodiscard]] bool ComputeAtGoal(FeatureState& state) const noexcept;

  // Reads a measured sphere or circle. False if `measurement` is of another target or of none in front of the
  // camera. Real-time: yes.
  [[nodiscard]] bool Lift(const hal::FeatureMeasurement& measurement, LiftedTarget& lifted) const noexcept;

  // The same for a square or triangle. Omits poses that are invalid or not in front of the camera.
  // Real-time: yes.
  [[nodiscard]] bool TakeCorners(const hal::FeatureMeasurement& measurement,
                                 SeenCorners& seen) const noexcept;
};

}  // namespace fovea::features
