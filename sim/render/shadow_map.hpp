// SPDX-License-Identifier: Apache-2.0
// Depth map of the bench from the sun: the nearest surface is lit, everything behind it is in shadow.
//
// Static things are drawn once; moving things are drawn onto a copy.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <functional>

#include "sim/render/gl_program.hpp"
#include "sim/render/gpu_mesh.hpp"

namespace fovea::sim {

class ShadowMap {
 public:
  // Draws one mesh at a pose in B.
  using DrawAt = std::function<void(const GpuMesh& mesh, const Eigen::Matrix4f& B_of_mesh)>;
  // Calls DrawAt for each thing that casts a shadow.
  using DrawAll = std::function<void(const DrawAt& draw)>;

  explicit ShadowMap(int size_px);
  ~ShadowMap();
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;

  void DrawStatic(const DrawAll& draw_all);
  void DrawMoving(const DrawAll& draw_all);

  [[nodiscard]] GLuint texture() const { return maps_[1]; }
  [[nodiscard]] int size_px() const { return size_px_; }
  [[nodiscard]] float texel_m() const;  // size of one texel [m]
  // From B to the map: x, y from 0 to 1, z the depth to compare.
  [[nodiscard]] const Eigen::Matrix4f& map_of_B() const { return map_of_B_; }

 private:
  void Draw(const DrawAll& draw_all) const;

  int size_px_;
  GlProgram program_;
  GLuint frames_[2] = {0, 0};  // static things; all things
  GLuint maps_[2] = {0, 0};
  Eigen::Matrix4f clip_of_B_;
  Eigen::Matrix4f map_of_B_;
};

}  // namespace fovea::sim
