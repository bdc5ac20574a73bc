// SPDX-License-Identifier: Apache-2.0
// Starts of an atlas: a start posture and a target, drawn at random until both are feasible.
//
// Arm, camera and goal are those of the scene. A draw: each joint uniform in its range less 5 degrees at each
// end; the target's centre uniform in the picture, its depth uniform from 0.25 to 0.90 m; a flat target
// tilted against the picture by up to 45 degrees about any direction in it, and turned by any angle. The draw
// is rejected for the first reason of Rejection that applies, which are all geometry of the start or of the
// goal. Whether a way leads from one to the other is asked later, and only of failed runs (judge.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "tools/fovea/atlas/goal_postures.hpp"

namespace fovea::atlas {

enum class Rejection : std::uint8_t {
  kStartOutsideBarrier,  // the hand is outside the workspace
  kStartNearSolid,       // the arm is too near to the table or to another solid
  kTargetNearEdge,       // its outline is not completely 30 px inside the picture
  kTargetOutOfReach,     // it is nearer or farther than the detector looks for it
  kTargetBelowTable,     // the target intersects the table
  kArmInTheWay,          // the arm is too near to itself, the target or a line of sight
  kThingInTheWay,        // a thing on the bench intersects the target or a line of sight
  kNoGoalPosture,        // no posture found that reaches the goal and meets all these conditions
};
inline constexpr std::array<const char*, 8> kRejectionNames{
    "start_outside_barrier", "start_near_solid", "target_near_edge", "target_out_of_reach",
    "target_below_table",    "arm_in_the_way",   "thing_in_the_way", "no_goal_posture"};
// Descriptions for people, in the same order.
inline constexpr std::array<const char*, kRejectionNames.size()> kRejectionWords{
    "hand outside the workspace, or less than 3 mm inside the servo's bound",
    "links less than 2 cm, hand or camera less than 4 cm farther from table and boxes than the servo keeps "
    "them",
    "the target's outline is not completely 30 px inside the picture",
    "the target is nearer to the camera than vision.distance_min, or farther than vision.distance_max",
    "the target intersects the table",
    "the arm is too near to itself, the target or the line of sight, or hides a part of the target",
    "an object or a box on the bench is in or near the target or a line of sight",
    "no posture found that reaches the goal and meets all these conditions"};
using Rejections = std::array<std::uint64_t, kRejectionNames.size()>;

struct Start {
  std::vector<double> q;                   // [num_joints], to 1e-4 [rad]
  model::Vec3 p_BO = model::Vec3::Zero();  // to 1e-4 [m]
  std::array<double, 3> rpy_deg{};         // of O in B about fixed axes, to 0.01 [deg]
  std::uint32_t run_seed = 0;              // of the run's own noise
  std::uint64_t way_seed = 0;              // of the search for a way
  double u_px = 0.0;                       // the target's centre in the picture at the start
  double v_px = 0.0;
  double depth = 0.0;        // [m]
  double tilt_deg = 0.0;     // between a flat target and the picture
  double error_px = 0.0;     // distance of the image from its goal, rms over the target's points
  Rejections rejections{};   // the draws before this start
  int line = 0;              // in the file of --starts; 0: drawn at random
  std::optional<Goal> goal;  // of this start alone

  [[nodiscard]] model::Pose TargetPose() const;  // X_BO
};

class Sampler {
 public:
  explicit Sampler(const Scene& scene) : goals_(scene) {}

  // The start of run `index` (0 or more). It depends only on `seed` and `index`. Throws std::runtime_error
  // after a million draws.
  [[nodiscard]] Start Draw(std::uint64_t seed, int index) const;

  // Why no run can begin at `q` with the target at `X_BO`; none if it can.
  [[nodiscard]] std::optional<Rejection> Refusal(const StartPosture& posture, const model::Pose& X_BO) const;
  // Fills in what follows from posture and target of a start.
  void Describe(Start& start) const;

  [[nodiscard]] const GoalPostures& goals() const { return goals_; }

 private:
  [[nodiscard]] model::Pose DrawTarget(std::mt19937_64& engine) const;
  [[nodiscard]] double ErrorPx(const model::Pose& X_CO) const;

  GoalPostures goals_;
};

}  // namespace fovea::atlas
