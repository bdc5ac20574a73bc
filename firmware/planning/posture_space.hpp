// SPDX-License-Identifier: Apache-2.0
// The postures that a motion may pass: inside the joints' ranges, clear of everything that the guard keeps
// the arm from, with the target in the picture and in sight.
//
// The bounds are those of firmware/core/barriers, plus some room, so that the tick's own limits need not
// interfere. Where the start has less room than that, it is the start's. A hand's singularity bounds the goal
// alone: a joint motion may cross one, as in the tick.
#pragma once

#include <array>

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/field_of_view_barrier.hpp"
#include "firmware/core/barriers/levers.hpp"
#include "firmware/core/barriers/line_of_sight_barrier.hpp"
#include "firmware/core/barriers/motion_limits.hpp"
#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/trajectory/plan.hpp"
#include "firmware/core/trajectory/plan_request.hpp"
#include "firmware/planning/eye_reach.hpp"
#include "firmware/planning/work.hpp"

namespace fovea::planning {

// A posture with all that follows from it.
struct Posture {
  model::VecN q;  // [num_joints]
  model::ArmPoses poses;
  model::Pose X_BC;
  model::Pose X_CO;
  model::Mat6N J_C;  // body Jacobian of the camera
  barriers::PictureBarriers picture;
  // Target in front of the camera, where the detector looks for it; a flat one shows its painted side, not
  // too obliquely.
  bool is_faced = false;
};

struct Range {
  model::VecN least;  // [num_joints]
  model::VecN most;

  [[nodiscard]] model::VecN Clamped(const model::VecN& q) const noexcept {
    return q.cwiseMax(least).cwiseMin(most);
  }
};

class PostureSpace {
 public:
  // `config` must outlive the space.
  explicit PostureSpace(const config::ServoConfig& config, const EyeReach& reach = {}) noexcept;

  // Sets target and start. kFound if the start is allowed; else the reason, with the limit in `blocker`.
  [[nodiscard]] trajectory::PlanOutcome Begin(const trajectory::PlanRequest& request,
                                              hal::Limit& blocker) noexcept;

  // From here to the next Begin, a goal needs less room before joints' ends, a singularity and, as the path
  // to it, lines of sight. False if it already does.
  bool AllowTightGoals() noexcept;
  // From here to the next Begin, a path needs less room before lines of sight, and may show a flat target
  // from a steeper side.
  void AllowNarrowPassages() noexcept;
  // From here to the next Begin, a flat target that looks wide may be shown from a still steeper side.
  void AllowSteepViews() noexcept;

  // The posture at `q`; spends one unit of work. Joint ranges are not checked here.
  void Place(const model::VecN& q, Work& work, Posture& posture) const noexcept;

  struct Verdict {
    bool is_free = false;
    hal::Limit blocker = hal::Limit::kWorkspace;
    double travel = 0.0;  // if free: every point of the arm may move this far before a bound [m]
  };
  // `share` of the room that a search keeps; with 0, the guard's own bounds.
  [[nodiscard]] Verdict Judge(const Posture& posture, double share = 1.0) const noexcept;
  [[nodiscard]] bool IsFree(const model::VecN& q, Work& work) const noexcept;
  // True if the hand is as far from a singularity as a goal must be.
  [[nodiscard]] bool IsRegular(const Posture& posture) const noexcept;
  // The target's smallest distance from the picture's edges, less the distance that a path keeps.
  [[nodiscard]] double PictureRoom(const Posture& posture) const noexcept;

  // Turns the camera so that the target's centre moves by `share` of the way to the direction `d_C` (of
  // length 1, in axes of C): one Gauss-Newton step, in the joints' ranges.
  [[nodiscard]] model::VecN LookStep(const Posture& posture, const model::Vec3& d_C,
                                     double share) const noexcept;
  // Moves `q` a few such steps until the target is in the picture, and leaves `posture` there. False if
  // that fails.
  [[nodiscard]] bool PullIntoView(model::VecN& q, Work& work, Posture& posture) const noexcept;

  // All of the tick's limits of the joints' velocities at `posture`, as the motion there runs with `dq`.
  void LimitsAt(const Posture& posture, const model::VecN& dq, barriers::MotionLimits& limits) const noexcept;

  [[nodiscard]] const config::ServoConfig& config() const noexcept { return config_; }
  [[nodiscard]] const Range& range() const noexcept { return range_; }            // of a path
  [[nodiscard]] const Range& goal_range() const noexcept { return goal_range_; }  // of a goal
  [[nodiscard]] const model::Pose& X_BO() const noexcept { return X_BO_; }
  [[nodiscard]] const barriers::PerJoint& levers() const noexcept { return levers_; }
  // Distance of two postures: Euclidean, 0.3 m of a prismatic joint count as 1 rad.
  [[nodiscard]] double Distance(const model::VecN& a, const model::VecN& b) const noexcept {
    return (a - b).cwiseProduct(scale_).norm();
  }

 private:
  static constexpr std::size_t kMostSolids = barriers::SolidBarriers::kMost;

  // Whether a flat target is seen from enough of its front.
  [[nodiscard]] bool IsFaced(const Posture& posture) const noexcept;
  // Cosine between a flat target's normal and the line of sight.
  [[nodiscard]] static double CosineTo(const Posture& posture) noexcept;
  // Largest absolute cosine of a flat target's corners, as the picture shows them; 0 without corners, or if
  // the target need not stay in the picture.
  [[nodiscard]] double SharpestCorner(const Posture& posture) const noexcept;
  [[nodiscard]] double Tilt(const Posture& posture) const noexcept;
  // A room before a bound that grows from `at_start` there to `at_last`.
  [[nodiscard]] double RoomAt(const model::VecN& q, double at_start, double at_last) const noexcept;
  // Before the edges of the picture, normalised.
  [[nodiscard]] double NeededRoom(const model::VecN& q) const noexcept;
  [[nodiscard]] barriers::Sight SightAt(const Posture& posture,
                                        const barriers::ArmBodies& bodies) const noexcept;
  [[nodiscard]] double SightRoom(const Posture& posture, const barriers::ArmBodies& bodies) const noexcept;

  const config::ServoConfig& config_;
  const EyeReach detector_;  // as configured
  EyeReach reach_;           // with some room, or what the start has
  barriers::SolidBarriers solid_;
  features::TargetOutline outline_;
  double narrowest_;  // height of a plate over one of its sides [m]
  barriers::PerJoint levers_;
  model::VecN scale_;                         // of each joint in Distance
  std::array<double, kMostSolids> margin_{};  // of each solid's row in the tick [m]
  std::array<double, kMostSolids> room_{};    // that a path keeps beyond [m]
  // What the proof uses instead of margin_ [m]: from a start nearer than that, the guard's proof of a stop's.
  std::array<double, kMostSolids> bound_{};
  double steepest_ = 0.0;       // least CosineTo
  double wide_steepest_ = 0.0;  // the same of a target that looks wide
  double sharpest_ = 1.0;       // most SharpestCorner
  model::VecN q_start_;
  double start_room_ = 0.0;  // before the picture's edges at the start, normalised
  double sight_room_ = 0.0;  // [m]
  double tilt_room_ = 0.0;   // at the start, cosine
  Range range_;
  Range goal_range_;
  double singularity_room_ = 0.0;  // times the guard's smallest singular value
  model::Pose X_BO_;
  model::Vec3 normal_B_ = model::Vec3::Zero();
};

}  // namespace fovea::planning
