// A mesh with fewer triangles, for its shadow.
#pragma once

#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

// `mesh` with all vertices of a cube of `cell` [m] taken as one, at their mean; what becomes flat is gone. It
// lies within one cell of the mesh. Normals and colours are those of one of the vertices.
Mesh Simplify(const Mesh& mesh, float cell);

}  // namespace fovea::sim
