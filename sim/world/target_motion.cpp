// SPDX-License-Identifier: Apache-2.0
#include "sim/world/target_motion.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace fovea::sim {
namespace {

constexpr double kGravity = 9.81;       // [m/s^2]
constexpr double kPendulumSwing = 0.5;  // largest angle of a pendulum [rad]

Eigen::Vector3d Aside(const Eigen::Vector3d& direction) { return Eigen::Vector3d::UnitZ().cross(direction); }

// A sum of two sines per axis, with random periods from the seed. It stays within `reach` and below `speed`.
Eigen::Vector3d Wander(const TargetMotion& motion, double t) {
  std::mt19937_64 engine(motion.seed);
  const auto uniform = [&engine](double low, double high) {
    return low + (high - low) * static_cast<double>(engine() >> 11U) * 0x1p-53;
  };
  const double size = motion.reach / std::sqrt(3.0);
  const double fastest = motion.speed / motion.reach;  // upper bound of the angular frequencies [rad/s]
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const double slow = fastest * uniform(0.3, 0.6);
    const double fast = fastest * uniform(0.7, 1.0);
    const double slow_phase = uniform(0.0, 2.0 * std::numbers::pi);
    const double fast_phase = uniform(0.0, 2.0 * std::numbers::pi);
    p[axis] = 0.5 * size * (std::sin(slow * t + slow_phase) + std::sin(fast * t + fast_phase));
  }
  return p;
}

}  // namespace

Eigen::Vector3d PositionAt(const TargetMotion& motion, std::int64_t time_ns) {
  const double t = static_cast<double>(time_ns) * 1e-9;
  if (motion.kind == MotionKind::kJump) {
    return t < motion.jump_s ? motion.p_BO : Eigen::Vector3d(motion.p_BO + motion.jump);
  }
  if (motion.kind == MotionKind::kStill || motion.reach <= 0.0) {
    return motion.p_BO;
  }
  const double angle = motion.speed / motion.reach * t;
  switch (motion.kind) {
    case MotionKind::kStill:
    case MotionKind::kJump:
    case MotionKind::kPushed: break;
    case MotionKind::kCircle:
      return motion.p_BO + motion.reach * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
    case MotionKind::kLine: return motion.p_BO + motion.reach * std::sin(angle) * motion.direction;
    case MotionKind::kEight: {
      // Gerono's lemniscate: fastest at its centre, sqrt(2) times as fast as one sine alone.
      const double a = angle / std::numbers::sqrt2;
      return motion.p_BO + motion.reach * (std::sin(a) * motion.direction +
                                           std::sin(a) * std::cos(a) * Aside(motion.direction));
    }
    case MotionKind::kPendulum: {
      const double swing = kPendulumSwing * std::sin(std::sqrt(kGravity / motion.reach) * t);
      return motion.p_BO + motion.reach * (std::sin(swing) * motion.direction +
                                           (1.0 - std::cos(swing)) * Eigen::Vector3d::UnitZ());
    }
    case MotionKind::kWander: return motion.p_BO + Wander(motion, t);
  }
  return motion.p_BO;
}

Eigen::Matrix3d OrientationAt(const TargetMotion& motion, std::int64_t time_ns) {
  if (motion.turn_rate == 0.0) {
    return motion.R_BO;
  }
  const double angle = motion.turn_rate * static_cast<double>(time_ns) * 1e-9;
  return motion.R_BO * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace fovea::sim
