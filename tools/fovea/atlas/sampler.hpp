// SPDX-License-Identifier: Apache-2.0
// Starts of an atlas: a start posture and a target, drawn at random until both are feasible.
//
// The arm, the camera and the goal are those of the scenario `ball` (a Panda; 640x480, 60 degrees; centred at
// 0.40 m). A draw: each joint uniform in its range less 5 degrees at each end; the target's centre uniform in
// the picture, its depth uniform from 0.25 to 0.90 m; a flat target tilted against the picture by up to 45
// degrees about any direction in it, and turned by any angle. The draw is rejected for the first reason of
// Rejection that applies: the geometry, or that no path was found. A difficult start is never rejected, so
// the success rate covers all starts for which the search finds a path.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "tools/fovea/atlas/checks.hpp"

namespace fovea::atlas {

enum class Rejection : std::uint8_t {
  kStartOutsideBarrier,  // the hand is outside the workspace
  kStartBelowTable,      // elbow, forearm, wrist, hand or camera lower than 0.10 m above the table
  kTargetNearEdge,       // its outline is not completely 30 px inside the picture
  kTargetBelowTable,     // the target intersects the table
  kArmInTheWay,          // the arm intersects itself, the target or a line of sight
  kThingInTheWay,        // a thing on the bench intersects the target or a line of sight
  kNoGoalPosture,        // no posture found that reaches the goal and meets all these conditions
  kNoWay,                // no joint path found to such a posture with the target in view (way.hpp)
};
inline constexpr std::array<const char*, 8> kRejectionNames{
    "start_outside_barrier", "start_below_table", "target_near_edge", "target_below_table",
    "arm_in_the_way",        "thing_in_the_way",  "no_goal_posture",  "no_way"};
// Descriptions for people, in the same order.
inline constexpr std::array<const char*, kRejectionNames.size()> kRejectionWords{
    "hand outside the workspace (0.845 m: 3 mm inside the servo's bound of 0.848 m)",
    "elbow, forearm, wrist, hand or camera lower than 0.10 m above the table",
    "the target's outline is not completely 30 px inside the picture",
    "the target intersects the table",
    "the arm intersects itself, the target or the line of sight",
    "an object on the bench intersects the target or the line of sight",
    "no posture found that reaches the goal and meets all these conditions",
    "such a posture was found, but no joint path to one that keeps the target in view"};
using Rejections = std::array<std::uint64_t, kRejectionNames.size()>;

struct Start {
  std::vector<double> q;          // [num_joints], to 1e-4 [rad]
  model::Vec3 p_BO;               // to 1e-4 [m]
  std::array<double, 3> rpy_deg;  // of O in B about fixed axes, to 0.01 [deg]
  std::uint32_t run_seed = 0;     // of the run's own noise
  double u_px = 0.0;              // the target's centre in the picture at the start
  double v_px = 0.0;
  double depth = 0.0;       // [m]
  double tilt_deg = 0.0;    // between a flat target and the picture
  double error_px = 0.0;    // distance of the image from its goal, rms over the target's points
  Rejections rejections{};  // the draws before this start
};

class Sampler {
 public:
  // `feature`: the target with its goal.
  Sampler(const model::ArmModel& arm, const features::TargetFeature& feature);

  // The start of run `index` (0 or more). It depends only on `seed` and `index`. Throws std::runtime_error
  // after a million draws.
  [[nodiscard]] Start Draw(std::uint64_t seed, int index) const;

 private:
  [[nodiscard]] model::VecN DrawPosture(std::mt19937_64& engine) const;
  [[nodiscard]] model::Pose DrawTarget(std::mt19937_64& engine) const;
  // Postures with the target at its goal: the ends of descents from `q`, from near it and from anywhere.
  [[nodiscard]] std::vector<model::VecN> FindGoals(const model::VecN& q, const model::Pose& X_BO,
                                                   std::mt19937_64& engine) const;
  // The goal posture that a descent from `q` reaches, or none.
  [[nodiscard]] std::optional<model::VecN> DescentTo(const model::VecN& q, const model::Pose& X_BO) const;
  [[nodiscard]] bool WayLeadsOn(const model::VecN& q, const model::Pose& X_BO,
                                const std::vector<model::VecN>& goals, std::uint64_t seed) const;
  [[nodiscard]] model::VecN PulledIntoView(const model::VecN& q, const model::Pose& X_BO) const;
  [[nodiscard]] model::Mat3 NearestGoal(const model::Mat3& R_CO) const;
  [[nodiscard]] double ErrorPx(const model::Pose& X_CO) const;

  model::ArmModel arm_;
  features::TargetFeature feature_;
  StartChecks checks_;
  model::VecN q_least_;  // the joints' range, less the margin
  model::VecN q_most_;
};

}  // namespace fovea::atlas
