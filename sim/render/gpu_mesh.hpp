// SPDX-License-Identifier: Apache-2.0
// A mesh in the driver's memory. The OpenGL context must be current to create, draw or destroy it.
#pragma once

#include <epoxy/gl.h>

#include "sim/render/mesh.hpp"

namespace fovea::sim {

class GpuMesh {
 public:
  explicit GpuMesh(const Mesh& mesh);
  ~GpuMesh();
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;

  // Attributes: 0 position, 1 normal, 2 colour.
  void Draw() const;

 private:
  GLuint vertex_array_ = 0;
  GLuint vertices_ = 0;
  GLuint indices_ = 0;
  GLsizei num_indices_ = 0;
};

// std::runtime_error naming `what`: the bound framebuffer is not complete.
void CheckFramebuffer(const char* what);

}  // namespace fovea::sim
