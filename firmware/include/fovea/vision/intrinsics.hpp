// A calibrated pinhole camera: u = f_u X / Z + c_u, v = f_v Y / Z + c_v; pixel centres at whole numbers.
#pragma once

#include "fovea/model/types.hpp"

namespace fovea::vision {

struct Intrinsics {
  int width_px = 0;
  int height_px = 0;
  double f_u_px = 0.0;
  double f_v_px = 0.0;
  double c_u_px = 0.0;
  double c_v_px = 0.0;

  // The ray (x, y, 1) of a pixel, in axes of C.
  [[nodiscard]] model::Vec3 Ray(double u_px, double v_px) const {
    return {(u_px - c_u_px) / f_u_px, (v_px - c_v_px) / f_v_px, 1.0};
  }
  [[nodiscard]] double U(const model::Vec3& p_C) const { return f_u_px * p_C.x() / p_C.z() + c_u_px; }
  [[nodiscard]] double V(const model::Vec3& p_C) const { return f_v_px * p_C.y() / p_C.z() + c_v_px; }
};

}  // namespace fovea::vision
