// Smooths the outlines of meshes, where one ends and something further off begins.
//
// Sampling each pixel several times would do it too, at twice the cost of the whole picture in software. Here
// each edge of the outline gets a hem one pixel wide that fades from the mesh's colour to nothing, as a pixel
// does that the edge crosses. (A mesh so looks half a pixel larger. Balls, which are measured, are drawn
// exactly.)
#pragma once

#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <vector>

#include "sim/render/mesh.hpp"

namespace fovea::sim {

// An edge between two faces of a mesh; seen from outside, face A lies to the left of from -> to.
struct MeshEdge {
  Eigen::Vector3f from;
  Eigen::Vector3f to;
  Eigen::Vector3f normal_a;  // of the faces
  Eigen::Vector3f normal_b;
  Eigen::Vector3f colour;
};

// The edges of a closed mesh, corners that coincide taken as one. None of a mesh with more than 20 000
// triangles: looking at all of its edges would cost more per picture than drawing it, and its outline stays a
// little rough.
std::vector<MeshEdge> FindEdges(const Mesh& mesh);

class OutlineSmoother {
 public:
  OutlineSmoother();
  ~OutlineSmoother();
  OutlineSmoother(const OutlineSmoother&) = delete;
  OutlineSmoother& operator=(const OutlineSmoother&) = delete;

  // Adds the hems of a mesh at `X_BM` as seen from `eye_B`.
  void Add(const std::vector<MeshEdge>& edges, const Eigen::Isometry3f& X_BM, const Eigen::Vector3f& eye_B);
  // Draws what was added, with the program in use (shaders::kHemVertex), and forgets it.
  void Draw();

 private:
  struct HemVertex {
    Eigen::Vector3f position;  // in B
    Eigen::Vector3f other;     // the edge's other end
    Eigen::Vector3f normal;
    Eigen::Vector3f colour;
    Eigen::Vector2f hem;  // which way out (+1, -1); share of the hem's width (0, 1)
  };

  GLuint vertex_array_ = 0;
  GLuint buffer_ = 0;
  std::vector<HemVertex> vertices_;
};

}  // namespace fovea::sim
