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
// With a `root`, for a URDF that a stranger's file names, the file must lie in it, links followed, or be a
// package's of those two variables, which are the user's own.
//
// std::runtime_error with one line that says where the file was looked for, without naming `urdf`.
std::filesystem::path FindMeshFile(const std::filesystem::path& urdf, const std::string& filename,
                                   const std::filesystem::path& root = {});

// Whether `file` lies in `folder` or below it, links followed.
[[nodiscard]] bool LiesIn(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace fovea::sim
