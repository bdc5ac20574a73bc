// SPDX-License-Identifier: Apache-2.0
// Draws balls by their exact outline, not by triangles: each pixel by its covered share.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "sim/render/gl_program.hpp"
#include "sim/render/pinhole.hpp"

namespace fovea::sim {

// A ball in axes of C.
struct SeenBall {
  Eigen::Vector3f centre;
  float radius = 0.0F;
  Eigen::Vector3f colour;
  // While the rows of a band are exposed, with ROLLING: `centre` is in the middle.
  Eigen::Vector3f first = centre;
  Eigen::Vector3f last = centre;
};

class BallPainter {
 public:
  // `head`: the GLSL preamble that sets the quality of shadows, and ROLLING.
  explicit BallPainter(const std::string& head);
  ~BallPainter();
  BallPainter(const BallPainter&) = delete;
  BallPainter& operator=(const BallPainter&) = delete;

  // Set its light uniforms before Draw.
  [[nodiscard]] const GlProgram& program() const { return program_; }
  // Draws the visible ones of `balls` over their background, far ones first. `rows`: with ROLLING, the rows
  // of the sensor from a ball's first place to its last.
  void Draw(std::vector<SeenBall> balls, const Eigen::Isometry3f& X_BC, const Pinhole& pinhole,
            const Eigen::Matrix4f& clip_of_C, const std::optional<float>& rows) const;

 private:
  GlProgram program_;
  GLuint no_vertices_ = 0;  // they are drawn from uniforms only
};

}  // namespace fovea::sim
