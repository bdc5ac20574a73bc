// SPDX-License-Identifier: Apache-2.0
// A calibrated camera: u = f_u X / Z + c_u, v = f_v Y / Z + c_v; pixel centres at integers.
//
// All computations use ideal pixels, those of a lens without distortion. Pictures are never rectified: a
// point of the ideal picture is read at its distorted position.
#pragma once

#include <cmath>

#include "firmware/core/model/types.hpp"

namespace fovea::vision {

// Brown's lens model: radial k1, k2, k3, tangential p1, p2; all zero for a lens without distortion.
struct Distortion {
  double k1 = 0.0;
  double k2 = 0.0;
  double p1 = 0.0;
  double p2 = 0.0;
  double k3 = 0.0;

  [[nodiscard]] bool IsZero() const { return k1 == 0.0 && k2 == 0.0 && p1 == 0.0 && p2 == 0.0 && k3 == 0.0; }
};

struct Intrinsics {
  int width_px = 0;
  int height_px = 0;
  double f_u_px = 0.0;
  double f_v_px = 0.0;
  double c_u_px = 0.0;
  double c_v_px = 0.0;
  Distortion lens{};
  double row_time = 0.0;  // of a rolling shutter: from one row to the next [s]; the stamp is the middle row's

  // The ray (x, y, 1) of an ideal pixel, in axes of C.
  [[nodiscard]] model::Vec3 Ray(double u_px, double v_px) const {
    return {(u_px - c_u_px) / f_u_px, (v_px - c_v_px) / f_v_px, 1.0};
  }
  [[nodiscard]] double U(const model::Vec3& p_C) const { return f_u_px * p_C.x() / p_C.z() + c_u_px; }
  [[nodiscard]] double V(const model::Vec3& p_C) const { return f_v_px * p_C.y() / p_C.z() + c_v_px; }

  // From an ideal pixel to its distorted position, and back.
  void Distort(double& u_px, double& v_px) const {
    if (lens.IsZero()) {
      return;
    }
    const double x = (u_px - c_u_px) / f_u_px;
    const double y = (v_px - c_v_px) / f_v_px;
    const double r2 = x * x + y * y;
    const double radial = 1.0 + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
    u_px = c_u_px + f_u_px * (x * radial + 2.0 * lens.p1 * x * y + lens.p2 * (r2 + 2.0 * x * x));
    v_px = c_v_px + f_v_px * (y * radial + lens.p1 * (r2 + 2.0 * y * y) + 2.0 * lens.p2 * x * y);
  }
  void Undistort(double& u_px, double& v_px) const {
    if (lens.IsZero()) {
      return;
    }
    constexpr int kRounds = 12;  // each reduces the error to a tenth or less for usual lenses
    const double measured_u = u_px;
    const double measured_v = v_px;
    for (int i = 0; i < kRounds; ++i) {
      double u = u_px;
      double v = v_px;
      Distort(u, v);
      u_px += measured_u - u;
      v_px += measured_v - v;
    }
  }
};

}  // namespace fovea::vision
