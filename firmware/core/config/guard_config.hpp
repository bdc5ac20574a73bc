// SPDX-License-Identifier: Apache-2.0
// [safety] motion limits, as shares of the arm's own limits or in their units, and obstacles around the arm.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "firmware/core/config/fields.hpp"
#include "firmware/core/config/predict_config.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::config {

// The half-space n p >= d, in B.
struct Plane {
  model::Vec3 normal = model::Vec3::UnitZ();  // of length 1
  double distance = 0.0;                      // [m]
};

// Planes and boxes that hand and links avoid. Boxes must not hide the target either.
struct Obstacles {
  static constexpr int kMost = 4;  // planes, and as many boxes
  int num_planes = 0;
  int num_boxes = 0;
  std::array<Plane, kMost> planes;
  std::array<Box, kMost> boxes;
};

// Parts bolted to the hand, as balls: the camera from the flange to its lens, and tools.
struct HandShape {
  static constexpr int kMost = 24;
  struct Ball {
    model::Vec3 p_EP = model::Vec3::Zero();  // centre, in axes of E [m]
    double radius = 0.0;                     // [m]
  };
  int num_balls = 0;
  std::array<Ball, kMost> balls;

  // Adds a capsule from `p_EA` to `p_EB` [m in E] with `radius` [m] as balls that cover it. False, with only
  // a part added, when there is no room.
  [[nodiscard]] bool AddCapsule(const model::Vec3& p_EA, const model::Vec3& p_EB, double radius) noexcept;
};

// Bounds for the target: the picture less a margin, in the normalised image.
struct ViewConfig {
  bool enabled = false;
  double x_min = 0.0;
  double x_max = 0.0;
  double y_min = 0.0;
  double y_max = 0.0;
  double disc_cosine_min = 0.0;  // of a disc's tilt against the line of sight; 0: no limit
};

// Speed of the true hand relative to its reference, because light joints stick as they reverse and then catch
// up [m/s, rad/s]; and the smallest limits, which must be larger than that.
inline constexpr double kSpeedBeside = 0.005;
inline constexpr double kTurnBeside = 0.08;
inline constexpr double kLeastCartesianSpeed = 0.01;
inline constexpr double kLeastRotationSpeed = 0.2;

struct GuardConfig {
  double joint_velocity_fraction = 0.8;
  double joint_acceleration_fraction = 0.7;
  double joint_jerk_fraction = 0.025;  // low: larger values exceed the torque rate at long reach
  double joint_position_margin = 0.02;
  double braking_fraction = 0.5;
  double workspace_radius = 0.85;
  double workspace_margin = 0.002;
  double workspace_deceleration = 2.0;
  double cartesian_speed = 1.7;
  double singularity_min = 0.02;
  Obstacles obstacles;
  HandShape hand;
  double link_clearance = 0.01;
  ViewConfig view;
  double sight_clearance = 0.01;
  double self_clearance = 0.02;
  double barrier_rate = 1.5;
  double rotation_speed = 2.5;
};

// The largest shares of the hand's limits that a reference may use. Speed: a stop's proof checks sample
// points, and between them the speed can be 6 % higher. Rotation: the true hand turned 6 % faster.
inline constexpr double kSpeedShareMost = 0.94;
inline constexpr double kTurnShareMost = 0.90;

// The limits to which these shares apply [m/s, rad/s]. Low limits leave room for the two speeds above.
inline double SpeedLimitOfReference(const GuardConfig& c) noexcept {
  return std::min(c.cartesian_speed, (c.cartesian_speed - kSpeedBeside) / kSpeedShareMost);
}
inline double TurnLimitOfReference(const GuardConfig& c) noexcept {
  return std::min(c.rotation_speed, (c.rotation_speed - kTurnBeside) / kTurnShareMost);
}

template <class Visitor, Struct<GuardConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  // The arm needs the rest, because it follows its reference with an error.
  constexpr const char* kShare = "share of the arm's own limit that the reference may use";
  v.Number({"safety.joint_velocity_fraction", "", kShare}, c.joint_velocity_fraction, 0.001, 0.95);
  v.Number({"safety.joint_acceleration_fraction", "", kShare}, c.joint_acceleration_fraction, 0.001, 0.8);
  v.Number({"safety.joint_jerk_fraction", "", kShare}, c.joint_jerk_fraction, 0.001, 0.1);
  v.Number({"safety.joint_position_margin", "rad",
            "distance of the reference from the ends of each joint's range"},
           c.joint_position_margin, 0.0, 1.0);
  v.Number({"safety.braking_fraction", "",
            "share of the acceleration limit that stops a joint before the end of its range"},
           c.braking_fraction, 0.001, 0.8);
  v.Number({"safety.workspace_radius", "m", "the end effector stays in this sphere about the base"},
           c.workspace_radius, 0.01, 1000.0);
  v.Number({"safety.workspace_margin", "m",
            "distance of the reference from the edges of workspace, planes and boxes"},
           c.workspace_margin, 0.001, 1.0);
  v.Number({"safety.workspace_deceleration", "m/s^2",
            "deceleration of the end effector before the edges of workspace, planes and boxes"},
           c.workspace_deceleration, 0.01, 100.0);
  v.Number({"safety.cartesian_speed", "m/s", "speed limit of the end effector"}, c.cartesian_speed,
           kLeastCartesianSpeed, 100.0);
  v.Number({"safety.singularity_min", "",
            "smallest allowed singular value of the hand's Jacobian, with 1 m counted as 1 / 0.3 rad; a "
            "joint motion that ends above it may pass below; 0: no limit"},
           c.singularity_min, 0.0, 1.0);
  v.Count(
      {"safety.planes", "m",
       "planes n p >= d that hand, camera, tools and the arm's links stay above: n_x, n_y, n_z, d of each"},
      c.obstacles.num_planes, Obstacles::kMost);
  v.Count(
      {"safety.boxes", "m",
       "boxes that hand, camera, tools, links and lines of sight stay out of: low x, y, z, high x, y, z of "
       "each"},
      c.obstacles.num_boxes, Obstacles::kMost);
  for (auto& plane : c.obstacles.planes) {
    v.Derived({"safety.planes"}, plane.normal, -1.0, 1.0);
    v.Derived({"safety.planes"}, plane.distance, -1e9, 1e9);
  }
  for (auto& box : c.obstacles.boxes) {
    v.Derived({"safety.boxes"}, box.low, -1e9, 1e9);
    v.Derived({"safety.boxes"}, box.high, -1e9, 1e9);
  }
  v.Derived({"safety.keep_in_view", "", "keep the target in the picture"}, c.view.enabled);
  v.Derived({"safety.view_margin_px", "px", "distance of the target's outline from the picture's edge"},
            c.view.x_min, -1e6, 1e6);
  v.Derived({"safety.view_margin_px"}, c.view.x_max, -1e6, 1e6);
  v.Derived({"safety.view_margin_px"}, c.view.y_min, -1e6, 1e6);
  v.Derived({"safety.view_margin_px"}, c.view.y_max, -1e6, 1e6);
  v.Number(
      {"safety.sight_clearance", "m",
       "distance of the arm's own links, and of boxes, from the lines of sight to the target; what is nearer "
       "may not come nearer still; 0: no limit"},
      c.sight_clearance, 0.0, 10.0);
  v.Derived(
      {"safety.disc_tilt_max", "rad",
       "largest tilt of a disc's face against the line of sight; a larger tilt may not grow; pi / 2: no "
       "limit"},
      c.view.disc_cosine_min, 0.0, 1.0);
  v.Number({"safety.self_clearance", "m",
            "distance of the arm's links from each other; a pair that is nearer may not come nearer still; "
            "0: they may touch"},
           c.self_clearance, 0.0, 10.0);
  v.Count(
      {"safety.tools", "m",
       "tools on the hand, guarded as capsules: x, y, z of both ends in axes of the flange, radius of each"},
      c.hand.num_balls, HandShape::kMost);
  for (auto& ball : c.hand.balls) {
    v.Derived({"safety.tools"}, ball.p_EP, -1e6, 1e6);
    v.Derived({"safety.tools"}, ball.radius, 0.0, 1e6);
  }
  v.Number({"safety.link_clearance", "m", "distance of the arm's links from planes and boxes"},
           c.link_clearance, 0.0, 1.0);
  v.Number({"safety.barrier_rate", "1/s",
            "the distances to the picture's edge, to a line of sight, to a disc's largest tilt and between "
            "the arm's links shrink no faster than exp(-rate t)"},
           c.barrier_rate, 0.1, 20.0);
  v.Number({"safety.rotation_speed", "rad/s", "angular speed limit of the end effector"}, c.rotation_speed,
           kLeastRotationSpeed, 100.0);
}

}  // namespace fovea::config
