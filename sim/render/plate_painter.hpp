// SPDX-License-Identifier: Apache-2.0
// Draws a flat target by its exact outline, not by triangles: each pixel by its covered share.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>

#include "sim/render/gl_program.hpp"
#include "sim/render/gpu_mesh.hpp"
#include "sim/render/pinhole.hpp"
#include "sim/render/target_shape.hpp"

namespace fovea::sim {

// How a plate moves while the rows of a band are exposed.
struct PlateMotion {
  Eigen::Isometry3f X_CO_first;
  Eigen::Isometry3f X_CO_last;
  float rows = 0.0F;  // from the first pose to the last
};

class PlatePainter {
 public:
  // `head`: the GLSL preamble that sets the quality of shadows, and ROLLING. The shape is a disc or a
  // polygon.
  PlatePainter(const TargetShape& shape, const std::string& head);
  ~PlatePainter();
  PlatePainter(const PlatePainter&) = delete;
  PlatePainter& operator=(const PlatePainter&) = delete;

  // Set its light uniforms before Draw.
  [[nodiscard]] const GlProgram& program() const { return program_; }
  // Draws the plate at `X_CO` over its background, in `colour`. Draws nothing if its painted side faces away,
  // or if a part of it is beside or behind the camera. `motion`: with ROLLING; `X_CO` is in its middle.
  void Draw(const Eigen::Isometry3f& X_CO, const Eigen::Isometry3f& X_BC, const Pinhole& pinhole,
            const Eigen::Matrix4f& clip_of_C, const Eigen::Vector3f& colour,
            const std::optional<PlateMotion>& motion) const;
  // The mesh that casts its shadow, in O.
  [[nodiscard]] const GpuMesh& caster() const { return *caster_; }

 private:
  const TargetShape shape_;
  GlProgram program_;
  std::unique_ptr<GpuMesh> caster_;
  std::vector<Eigen::Vector3f> outline_;  // in O; for a disc, closely spaced points
  GLuint no_vertices_ = 0;

  void SetMotion(const PlateMotion& motion) const;
};

}  // namespace fovea::sim
