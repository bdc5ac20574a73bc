// SPDX-License-Identifier: Apache-2.0
// Smooths the outlines of meshes against their background.
//
// Multisampling would double the cost of the whole picture in software. Instead, each outline edge gets a
// hem: a strip one pixel wide that fades from the mesh's colour to transparent. A mesh therefore looks half a
// pixel larger. Balls, which are measured, are drawn exactly.
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <vector>

#include "sim/render/mesh.hpp"

namespace fovea::sim {

// An edge between two faces of a mesh. Seen from outside, face A is on the left of from -> to.
struct MeshEdge {
  Eigen::Vector3f from;
  Eigen::Vector3f to;
  Eigen::Vector3f normal_a;  // normals of the two faces
  Eigen::Vector3f normal_b;
  Eigen::Vector3f colour;
};

// The edges of a closed mesh; coincident corners are merged. Returns none for a mesh above 20 000 triangles:
// testing its edges would cost more per picture than drawing it. Its outline stays unsmoothed.
std::vector<MeshEdge> FindEdges(const Mesh& mesh);

class OutlineSmoother {
 public:
  OutlineSmoother();
  ~OutlineSmoother();
  OutlineSmoother(const OutlineSmoother&) = delete;
  OutlineSmoother& operator=(const OutlineSmoother&) = delete;

  // Adds the hems of a mesh at `X_BM` as seen from `eye_B`.
  void Add(const std::vector<MeshEdge>& edges, const Eigen::Isometry3f& X_BM, const Eigen::Vector3f& eye_B);
  // Draws the added hems with the program in use (shaders::kHemVertex), and clears them.
  void Draw();

 private:
  struct HemVertex {
    Eigen::Vector3f position;  // in B
    Eigen::Vector3f other;     // the edge's other end
    Eigen::Vector3f normal;
    Eigen::Vector3f colour;
    Eigen::Vector2f hem;  // outward side (+1, -1); share of the hem's width (0, 1)
  };

  GLuint vertex_array_ = 0;
  GLuint buffer_ = 0;
  std::vector<HemVertex> vertices_;
};

}  // namespace fovea::sim
