// Where the file is that a URDF's <mesh filename="..."/> names.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::sim {

// `filename` as it stands in `urdf`: package://name/rest, file:///absolute, an absolute path, or one relative
// to the URDF's folder. A package is looked for among the folders above the URDF (one that has its name, or
// that holds one), then as <entry>/name in ROS_PACKAGE_PATH, then as <entry>/share/name in AMENT_PREFIX_PATH;
// the first that has the file counts.
//
// std::runtime_error with one line that says where the file was looked for, without naming `urdf`.
std::filesystem::path FindMeshFile(const std::filesystem::path& urdf, const std::string& filename);

}  // namespace fovea::sim
