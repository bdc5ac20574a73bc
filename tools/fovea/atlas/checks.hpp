// What a start of an atlas and the postures of a way from it must keep: hand and arm, target and lines of
// sight, by the atlas's own geometry. It shares no code with the servo's, which would be the judge of itself.
#pragma once

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::atlas {

// The picture of the scenario `ball`.
inline constexpr double kWidthPx = 640.0;
inline constexpr double kHeightPx = 480.0;
[[nodiscard]] double FocalPx();
// Where the point is in the picture [px].
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
  // The hand is inside the workspace.
  [[nodiscard]] bool InsideBarrier(const StartPosture& posture) const;
  // Elbow, forearm, wrist, hand and camera are, by 0.10 m.
  [[nodiscard]] bool AboveTable(const StartPosture& posture) const;
  // The target's outline is wholly, by 30 px; and above the table.
  [[nodiscard]] bool InPicture(const model::Pose& X_CO) const;
  [[nodiscard]] bool TargetAboveTable(const model::Pose& X_BO) const;
  // The arm stands in itself, in the target or in a line of sight.
  [[nodiscard]] bool ArmInTheWay(const StartPosture& posture, const model::Pose& X_BO) const;
  // A thing on the bench stands in the target or in a line of sight.
  [[nodiscard]] bool BenchInTheWay(const StartPosture& posture, const model::Pose& X_BO) const;

  // All of it along a way, where it is somewhat less than at its ends.
  [[nodiscard]] bool OnTheWay(const StartPosture& posture, const model::Pose& X_BO) const;
  // The target is in front of the camera, but not wholly in the picture as a way keeps it.
  [[nodiscard]] bool OutOfViewOnTheWay(const model::Pose& X_CO) const;

  // X_EC.
  [[nodiscard]] const model::Pose& camera() const { return X_EC_; }

 private:
  // How far the arm's line keeps from what [m].
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
