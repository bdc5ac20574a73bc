// SPDX-License-Identifier: Apache-2.0
#include "sim/render/projection.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::sim {

Eigen::Matrix4f ClipOfC(const Pinhole& pinhole) {
  const auto w = static_cast<float>(pinhole.width_px);
  const auto h = static_cast<float>(pinhole.height_px);
  const auto f = static_cast<float>(pinhole.f_px);
  Eigen::Matrix4f clip = Eigen::Matrix4f::Zero();
  clip(0, 0) = 2.0F * f / w;
  clip(0, 2) = 2.0F * (static_cast<float>(pinhole.c_u_px) + 0.5F) / w - 1.0F;
  clip(1, 1) = 2.0F * f / h;
  clip(1, 2) = 2.0F * (static_cast<float>(pinhole.c_v_px) + 0.5F) / h - 1.0F;
  clip(2, 2) = (kFar + kNear) / (kFar - kNear);
  clip(2, 3) = -2.0F * kFar * kNear / (kFar - kNear);
  clip(3, 2) = 1.0F;
  return clip;
}

Eigen::Vector2f WindowDepth(const Eigen::Matrix4f& clip_of_C) {
  return {0.5F * clip_of_C(2, 2) + 0.5F, 0.5F * clip_of_C(2, 3)};
}

bool InView(const Pinhole& pinhole, const Eigen::Vector3f& p_C, float radius) {
  const auto f = static_cast<float>(pinhole.f_px);
  // `x` is not outside of the two side planes of the view's pyramid that belong to an axis by more than
  // radius.
  const auto is_between = [&](float x, int size_px, double c_px) {
    const auto c = static_cast<float>(c_px);
    const float low = (-0.5F - c) / f;
    const float high = (static_cast<float>(size_px) - 0.5F - c) / f;
    return (low * p_C.z() - x) / std::sqrt(1.0F + low * low) < radius &&
           (x - high * p_C.z()) / std::sqrt(1.0F + high * high) < radius;
  };
  return p_C.z() > -radius && is_between(p_C.x(), pinhole.width_px, pinhole.c_u_px) &&
         is_between(p_C.y(), pinhole.height_px, pinhole.c_v_px);
}

Eigen::Vector4f OutlineRectangle(const Eigen::Vector3f& p_C, float radius, float margin) {
  Eigen::Vector4f rectangle;
  const float z = p_C.z();
  for (int axis = 0; axis < 2; ++axis) {
    // In this plane, two rays are tangent to the ball: |x Z - c| = R sqrt(1 + x^2), a quadratic in x.
    const float c = p_C[axis];
    const float along = std::sqrt(std::max(c * c + z * z - radius * radius, 0.0F));
    const float a = (c * z - radius * along) / (z * z - radius * radius);
    const float b = (c * z + radius * along) / (z * z - radius * radius);
    rectangle[axis] = std::min(a, b) - margin;
    rectangle[axis + 2] = std::max(a, b) + margin;
  }
  return rectangle;
}

}  // namespace fovea::sim
