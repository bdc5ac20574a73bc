// SPDX-License-Identifier: Apache-2.0
// Reduces the triangles of a mesh, for its shadow.
#pragma once

#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

// Merges all vertices in each cube of `cell` [m] into their mean, and drops triangles without area. The
// result lies within one cell of `mesh`. Normals and colours are those of one of the merged vertices.
Mesh Simplify(const Mesh& mesh, float cell);

}  // namespace fovea::sim
