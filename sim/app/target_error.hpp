// How far the target is from its goal, in truth.
#pragma once

#include <limits>

#include "sim/render/pinhole.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

struct TargetError {
  double error_px = std::numeric_limits<double>::infinity();  // infinite when the target is behind the camera
  Eigen::Vector3d error_C = Eigen::Vector3d::Zero();          // goal less truth, in axes of C [m]
};

// `p_CO_C_star`: where the target shall be [m].
inline TargetError ErrorOf(const Truth& truth, const Pinhole& pinhole, const Eigen::Vector3d& p_CO_C_star) {
  const Eigen::Vector3d p_CO_C = truth.X_BC.inverse() * truth.p_BO;
  TargetError error;
  error.error_C = p_CO_C_star - p_CO_C;
  if (p_CO_C.z() > 0.0) {
    error.error_px = Eigen::Vector2d(pinhole.U(p_CO_C) - pinhole.U(p_CO_C_star),
                                     pinhole.V(p_CO_C) - pinhole.V(p_CO_C_star))
                         .norm();
  }
  return error;
}

}  // namespace fovea::sim
