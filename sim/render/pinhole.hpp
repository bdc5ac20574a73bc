// SPDX-License-Identifier: Apache-2.0
// The simulated camera's geometry: u = f_u X / Z + c_u, v = f_v Y / Z + c_v, pixel centres at integers.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace fovea::sim {

struct Pinhole {
  int width_px = 640;
  int height_px = 480;
  double f_px = 554.256258422041;  // f_u
  double c_u_px = 319.5;
  double c_v_px = 239.5;
  double aspect = 1.0;  // f_v / f_u

  [[nodiscard]] double FocalV() const { return aspect * f_px; }
  // True for square pixels and an optical axis in the middle of the picture. SceneRenderer draws only these.
  [[nodiscard]] bool IsPlain() const {
    return aspect == 1.0 && c_u_px == 0.5 * (width_px - 1) && c_v_px == 0.5 * (height_px - 1);
  }
  // Pixel coordinates of a point in front of the camera [px]; `p_C` in C [m].
  [[nodiscard]] double U(const Eigen::Vector3d& p_C) const { return f_px * p_C.x() / p_C.z() + c_u_px; }
  [[nodiscard]] double V(const Eigen::Vector3d& p_C) const { return FocalV() * p_C.y() / p_C.z() + c_v_px; }
};

// A rectangle of a picture's pixels.
struct PictureArea {
  int left_px = 0;
  int top_px = 0;
  int width_px = 0;
  int height_px = 0;
};

// A camera with horizontal field of view `hfov` [rad] and its optical axis in the middle of the picture.
inline Pinhole MakePinhole(int width_px, int height_px, double hfov) {
  return {width_px, height_px, 0.5 * width_px / std::tan(0.5 * hfov), 0.5 * (width_px - 1),
          0.5 * (height_px - 1)};
}

}  // namespace fovea::sim
