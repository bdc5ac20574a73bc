// SPDX-License-Identifier: Apache-2.0
// Reads mesh files of URDFs (STL, Collada, Wavefront) with assimp.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>

#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

inline constexpr std::size_t kMostMeshTriangles = 1'000'000;  // per file

// Reads a .stl (text or binary), .dae or .obj. All parts of the file become one mesh, at their poses in the
// file. `scale` (from the URDF, per axis, not 0; negative mirrors) converts the file's units to metres.
//
// Collada: applies the file's <unit> to lengths and ignores <up_axis>, as ROS's viewers do. Normals: those of
// the file; for STL those of the triangles, as the format prescribes; missing ones are computed, smooth
// across edges below 40 degrees. Colours: each material's diffuse colour, else grey. Textures are not read.
//
// std::runtime_error with one line, without the file's name: unsupported format, not readable, no triangles,
// more than kMostMeshTriangles, a coordinate that is not finite, a scale that is 0 or not finite.
//
// An .obj names other files that hold its colours. They must be regular files and, with a `root`, lie inside
// it after links are followed; otherwise the mesh has no colours.
Mesh LoadMeshFile(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                  const std::filesystem::path& root = {});

}  // namespace fovea::sim
