// SPDX-License-Identifier: Apache-2.0
// Conditions for a start of an atlas and for the postures of a path from it: hand and arm, target and lines
// of sight. The geometry shares no code with the servo, so the servo is not judged by its own code. The arm
// is the capsules of its model (model::ArmShape), so the conditions are the same for all arms.
#pragma once

#include <vector>

#include "tools/fovea/atlas/scene.hpp"

namespace fovea::atlas {

struct StartPosture {
  model::VecN q;
  model::ArmPoses poses;
  model::Pose X_BC;
  std::vector<model::Capsule> bodies;  // of the base and each link, in B
};

class StartChecks {
 public:
  explicit StartChecks(const Scene& scene);

  [[nodiscard]] StartPosture At(const model::VecN& q) const;
  // True when the hand is inside the workspace.
  [[nodiscard]] bool InsideBarrier(const StartPosture& posture) const;
  // True when links, hand and camera are clear of planes and boxes.
  [[nodiscard]] bool ClearOfSolids(const StartPosture& posture) const;
  // True when the target's outline is completely 30 px inside the picture; when its origin is as far from the
  // camera as the detector looks for it; when it is above the table.
  [[nodiscard]] bool InPicture(const model::Pose& X_CO) const;
  [[nodiscard]] bool InReach(const model::Pose& X_CO) const;
  [[nodiscard]] bool TargetAboveTable(const model::Pose& X_BO) const;
  // True when the arm is too close to itself, to the target or to a line of sight, or hides a part of the
  // target.
  [[nodiscard]] bool ArmInTheWay(const StartPosture& posture, const model::Pose& X_BO) const;
  // True when a thing or a box on the bench is in the target or in a line of sight.
  [[nodiscard]] bool BenchInTheWay(const StartPosture& posture, const model::Pose& X_BO) const;
  // True when a posture that reaches the goal meets all these conditions, and is not so near to a singular
  // one that the servo would not go there.
  [[nodiscard]] bool StandsAtGoal(const StartPosture& posture, const model::Pose& X_BO) const;

  // Cosine of a flat target's tilt: between its normal and the line of sight. 1 for a ball.
  [[nodiscard]] double CosineTo(const StartPosture& posture, const model::Pose& X_BO) const;
  // True when a posture on a path meets all conditions. The bounds are less strict than at the ends of drawn
  // starts: those that the servo's guard keeps, so that no way is denied that the servo may take.
  // `least_cosine`: of the tilt; a start with a larger tilt may be left.
  [[nodiscard]] bool OnTheWay(const StartPosture& posture, const model::Pose& X_BO,
                              double least_cosine) const;
  // The least cosine of a tilt that the servo may choose.
  [[nodiscard]] double LeastCosine() const;
  // The same of a posture that reaches the goal, which must not be too singular either.
  [[nodiscard]] bool StandsAtGoalByServo(const StartPosture& posture, const model::Pose& X_BO) const;
  // True when the target is in front of the camera but not completely in the picture, by the path's bound.
  [[nodiscard]] bool OutOfViewOnTheWay(const model::Pose& X_CO) const;

  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  // What the arm must keep beyond the servo's own bounds [m].
  struct Clear {
    double margins;    // how many times safety.workspace_margin planes and boxes are kept off
    double workspace;  // hand from the workspace's edge
    double links;      // from planes and boxes
    double hand;       // from planes and boxes
    double hand_ball;  // radius about flange and camera, besides the balls of the servo's hand
    double sight;      // links and boxes from lines of sight
    double itself;     // links from each other
    double target;     // whole arm and boxes from the target
    double things;     // on the bench, from the lines of sight and the target
  };
  static const Clear kAtEnds;
  static const Clear kOnTheWay;
  [[nodiscard]] bool InPicture(const model::Pose& X_CO, double edge_px) const;
  [[nodiscard]] bool InsideBarrier(const StartPosture& posture, const Clear& clear) const;
  [[nodiscard]] bool ClearOfSolids(const StartPosture& posture, const Clear& clear) const;
  [[nodiscard]] bool ArmInTheWay(const StartPosture& posture, const model::Pose& X_BO,
                                 const Clear& clear) const;
  [[nodiscard]] bool BenchInTheWay(const StartPosture& posture, const model::Pose& X_BO,
                                   const Clear& clear) const;
  [[nodiscard]] bool IsRegular(const StartPosture& posture) const;
  [[nodiscard]] bool IsHidden(const StartPosture& posture, const model::Pose& X_BO) const;

  Scene scene_;
  std::vector<config::Box> boxes_;  // on the bench, and those that the servo avoids
};

}  // namespace fovea::atlas
