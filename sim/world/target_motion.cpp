#include "sim/world/target_motion.hpp"

#include <cmath>

namespace fovea::sim {

Eigen::Vector3d PositionAt(const TargetMotion& motion, std::int64_t time_ns) {
  if (motion.kind == MotionKind::kStill || motion.path_radius <= 0.0) {
    return motion.p_BO;
  }
  const double angle = motion.speed / motion.path_radius * static_cast<double>(time_ns) * 1e-9;
  return motion.p_BO + motion.path_radius * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
}

}  // namespace fovea::sim
