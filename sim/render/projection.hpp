// SPDX-License-Identifier: Apache-2.0
// Converts the pinhole camera to OpenGL's conventions. No other file does so.
#pragma once

#include <Eigen/Geometry>

#include "sim/render/pinhole.hpp"

namespace fovea::sim {

inline constexpr float kNear = 0.02F;  // [m]
inline constexpr float kFar = 12.0F;   // [m]

// OpenGL's clip space for a camera in axes of C. Row 0 is the picture's top row, so the picture needs no
// flip. For OpenGL the world is therefore mirrored: front faces are clockwise.
Eigen::Matrix4f ClipOfC(const Pinhole& pinhole);

// (a, b) such that the depth buffer holds a + b / Z.
Eigen::Vector2f WindowDepth(const Eigen::Matrix4f& clip_of_C);

// Whether a ball of `radius` at `p_C` can be visible in the picture.
bool InView(const Pinhole& pinhole, const Eigen::Vector3f& p_C, float radius);

// The rectangle around the outline of a ball at `p_C`, widened by `margin`: x min, y min, x max, y max in the
// normalised image. The ball must be in front of the camera.
Eigen::Vector4f OutlineRectangle(const Eigen::Vector3f& p_C, float radius, float margin);

}  // namespace fovea::sim
