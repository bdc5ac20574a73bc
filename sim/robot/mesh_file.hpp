// Mesh files as URDFs name them (STL, Collada, Wavefront), read through assimp.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>

#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

inline constexpr std::size_t kMostMeshTriangles = 1'000'000;  // of one file

// Reads a .stl (text or binary), .dae or .obj. All that is in the file becomes one mesh, each part where the
// file puts it; `scale` (URDF's, per axis, not 0; a negative one mirrors) turns the file's units into metres.
//
// Collada: lengths are multiplied by the file's <unit>; <up_axis> does not turn anything: coordinates count
// as they are written, as ROS's viewers take them. Normals: the file's own, flat or smooth; STL's follow from
// its corners, as the format prescribes; where there are none they are made, smooth across edges of less than
// 40 degrees. Colours: the diffuse colour of each part's material, grey where there is none. Textures are not
// read.
//
// std::runtime_error with one line, without naming the file: another format, not readable, no triangles, more
// than kMostMeshTriangles, a coordinate that is not finite, a scale that is 0 or not finite.
//
// An .obj has its colours in files that it names itself. They must be files, and with a `root` lie in it,
// links followed; else it has no colours.
Mesh LoadMeshFile(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                  const std::filesystem::path& root = {});

}  // namespace fovea::sim
