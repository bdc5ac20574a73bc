// Where the target is at any time, as the scenario wants it.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace fovea::sim {

enum class MotionKind {
  kStill,
  kCircle,    // level, of radius `reach`
  kLine,      // to and fro along `direction`, `reach` each way, fastest in the middle
  kEight,     // level, of half length `reach` along `direction` and half width reach / 2
  kPendulum,  // on a string of length `reach` above its lowest place, in the plane of `direction`
  kWander,    // here and there, smoothly, within `reach`, by `seed`
  kJump,      // by `jump`, at once
  kPushed,    // a ball on the table that physics moves (World), from `p_BO` on
};

struct TargetMotion {
  MotionKind kind = MotionKind::kStill;
  Eigen::Vector3d p_BO = Eigen::Vector3d::Zero();        // where it rests, or the middle of its path [m]
  double reach = 0.0;                                    // [m]
  double speed = 0.0;                                    // along its path, the largest that it comes to [m/s]
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // of length 1; level for all but the line
  Eigen::Vector3d jump = Eigen::Vector3d::Zero();        // [m]
  double jump_s = 0.0;                                   // when
  std::uint64_t seed = 1;
  Eigen::Matrix3d R_BO = Eigen::Matrix3d::Identity();  // at the start
  double turn_rate = 0.0;                              // about its own z from then on [rad/s]
};

// The target's centre in B [m].
Eigen::Vector3d PositionAt(const TargetMotion& motion, std::int64_t time_ns);
Eigen::Matrix3d OrientationAt(const TargetMotion& motion, std::int64_t time_ns);

}  // namespace fovea::sim
