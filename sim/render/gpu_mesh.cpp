// SPDX-License-Identifier: Apache-2.0
#include "sim/render/gpu_mesh.hpp"

#include <cstddef>
#include <stdexcept>
#include <string>

namespace fovea::sim {

GpuMesh::GpuMesh(const Mesh& mesh) : num_indices_(static_cast<GLsizei>(mesh.indices.size())) {
  glGenVertexArrays(1, &vertex_array_);
  glGenBuffers(1, &vertices_);
  glGenBuffers(1, &indices_);
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(Vertex)),
               mesh.vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.indices.size() * sizeof(std::uint32_t)),
               mesh.indices.data(), GL_STATIC_DRAW);
  const std::size_t offsets[] = {offsetof(Vertex, position), offsetof(Vertex, normal),
                                 offsetof(Vertex, colour)};
  for (GLuint i = 0; i < 3; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(offsets[i]));
  }
}

GpuMesh::~GpuMesh() {
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteBuffers(1, &vertices_);
  glDeleteBuffers(1, &indices_);
}

void GpuMesh::Draw() const {
  if (num_indices_ > 0) {
    glBindVertexArray(vertex_array_);
    glDrawElements(GL_TRIANGLES, num_indices_, GL_UNSIGNED_INT, nullptr);
  }
}

void CheckFramebuffer(const char* what) {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error(std::string("the OpenGL driver cannot make the ") + what);
  }
}

}  // namespace fovea::sim
