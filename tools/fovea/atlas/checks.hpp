// SPDX-License-Identifier: Apache-2.0
// Conditions for a start of an atlas and for the postures of a path from it: hand and arm, target and lines
// of sight. The geometry shares no code with the servo, so the servo is not judged by its own code.
#pragma once

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::atlas {

// The picture of the scenario `ball`.
inline constexpr double kWidthPx = 640.0;
inline constexpr double kHeightPx = 480.0;
[[nodiscard]] double FocalPx();
// Position of the point in the picture [px].
[[nodiscard]] double U(const model::Vec3& p_C);
[[nodiscard]] double V(const model::Vec3& p_C);

struct StartPosture {
  model::VecN q;
  model::ArmPoses poses;
  model::Pose X_BC;
};

class StartChecks {
 public:
  // `feature`: the target with its goal.
  StartChecks(const model::ArmModel& arm, const features::TargetFeature& feature);

  [[nodiscard]] StartPosture At(const model::VecN& q) const;
  // True when the hand is inside the workspace.
  [[nodiscard]] bool InsideBarrier(const StartPosture& posture) const;
  // True when elbow, forearm, wrist, hand and camera are at least 0.10 m above the table.
  [[nodiscard]] bool AboveTable(const StartPosture& posture) const;
  // True when the target's outline is completely 30 px inside the picture; when it is above the table.
  [[nodiscard]] bool InPicture(const model::Pose& X_CO) const;
  [[nodiscard]] bool TargetAboveTable(const model::Pose& X_BO) const;
  // True when the arm is too close to itself, to the target or to a line of sight.
  [[nodiscard]] bool ArmInTheWay(const StartPosture& posture, const model::Pose& X_BO) const;
  // True when a thing on the bench is in the target or in a line of sight.
  [[nodiscard]] bool BenchInTheWay(const StartPosture& posture, const model::Pose& X_BO) const;

  // True when a posture on a path meets all conditions. The bounds are less strict than at its ends.
  [[nodiscard]] bool OnTheWay(const StartPosture& posture, const model::Pose& X_BO) const;
  // True when the target is in front of the camera but not completely in the picture, by the path's bound.
  [[nodiscard]] bool OutOfViewOnTheWay(const model::Pose& X_CO) const;

  // X_EC.
  [[nodiscard]] const model::Pose& camera() const { return X_EC_; }

 private:
  // Distances of the arm's segments from lines of sight, target and trunk [m].
  struct Clear {
    double sight;
    double target;
    double trunk;
  };
  static const Clear kAtEnds;
  static const Clear kOnTheWay;
  [[nodiscard]] bool InPicture(const model::Pose& X_CO, double edge_px) const;
  [[nodiscard]] bool AboveTable(const StartPosture& posture, double height) const;
  [[nodiscard]] bool ArmInTheWay(const StartPosture& posture, const model::Pose& X_BO,
                                 const Clear& clear) const;
  [[nodiscard]] model::Vec3 ForearmStart(const StartPosture& posture) const;

  model::ArmModel arm_;
  features::TargetFeature feature_;
  model::Pose X_EC_;
};

}  // namespace fovea::atlas
