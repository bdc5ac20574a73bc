// Where the target is at any time, as the scenario wants it.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace fovea::sim {

enum class MotionKind { kStill, kCircle };

struct TargetMotion {
  MotionKind kind = MotionKind::kStill;
  Eigen::Vector3d p_BO = Eigen::Vector3d::Zero();  // where it rests, or the middle of its path [m]
  double path_radius = 0.0;                        // of the circle, which lies level [m]
  double speed = 0.0;                              // along it [m/s]
};

// The target's centre in B [m].
Eigen::Vector3d PositionAt(const TargetMotion& motion, std::int64_t time_ns);

}  // namespace fovea::sim
