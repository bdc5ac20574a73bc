// SPDX-License-Identifier: Apache-2.0
// The target's pose as a function of time, by the scenario.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace fovea::sim {

enum class MotionKind {
  kStill,
  kCircle,    // horizontal, of radius `reach`
  kLine,      // back and forth along `direction`, `reach` each way, fastest in the middle
  kEight,     // horizontal figure of eight: half length `reach` along `direction`, half width reach / 2
  kPendulum,  // on a string of length `reach` above its lowest point, in the vertical plane of `direction`
  kWander,    // smooth random path within `reach`, by `seed`
  kJump,      // by `jump`, at once
  kPushed,    // a ball on the table, moved by the physics (World) from `p_BO` on
};

struct TargetMotion {
  MotionKind kind = MotionKind::kStill;
  Eigen::Vector3d p_BO = Eigen::Vector3d::Zero();        // position at rest, or centre of the path [m]
  double reach = 0.0;                                    // [m]
  double speed = 0.0;                                    // largest speed along the path [m/s]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit vector; horizontal except for the line
  Eigen::Vector3d jump = Eigen::Vector3d::Zero();        // [m]
  double jump_s = 0.0;                                   // time of the jump
  std::uint64_t seed = 1;
  Eigen::Matrix3d R_BO = Eigen::Matrix3d::Identity();  // at the start
  double turn_rate = 0.0;                              // about its own z, from the start on [rad/s]
};

// The target's centre in B [m].
Eigen::Vector3d PositionAt(const TargetMotion& motion, std::int64_t time_ns);
Eigen::Matrix3d OrientationAt(const TargetMotion& motion, std::int64_t time_ns);

}  // namespace fovea::sim
