// From the pinhole camera to OpenGL's conventions, in one place.
#pragma once

#include <Eigen/Geometry>

#include "sim/render/pinhole.hpp"

namespace fovea::sim {

inline constexpr float kNear = 0.02F;  // [m]
inline constexpr float kFar = 12.0F;   // [m]

// OpenGL's clip space for a camera in axes of C. Its row 0 is the picture's top row, so nothing is turned
// over on the way out; seen from OpenGL the world is mirrored, and front faces run clockwise.
Eigen::Matrix4f ClipOfC(const Pinhole& pinhole);

// (a, b) such that the depth buffer holds a + b / Z.
Eigen::Vector2f WindowDepth(const Eigen::Matrix4f& clip_of_C);

// Whether a ball of `radius` about `p_C` can be in the picture.
bool InView(const Pinhole& pinhole, const Eigen::Vector3f& p_C, float radius);

// The rectangle round the outline of a ball at `p_C`, in normalised image coordinates (x min, y min, x max,
// y max), widened by `margin`. The ball is before the camera.
Eigen::Vector4f OutlineRectangle(const Eigen::Vector3f& p_C, float radius, float margin);

}  // namespace fovea::sim
