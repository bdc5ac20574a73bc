// SPDX-License-Identifier: Apache-2.0
// Finds the file of a URDF's <mesh filename="..."/>.
#pragma once

#include <filesystem>
#include <string>

namespace fovea::sim {

// `filename` as written in `urdf`: package://name/rest, file:///absolute, an absolute path, or a path
// relative to the URDF's folder. A package is searched in the folders above the URDF (one with its name, or
// one that contains such a folder), then as <entry>/name in ROS_PACKAGE_PATH, then as <entry>/share/name in
// AMENT_PREFIX_PATH. The first that has the file is taken.
//
// A `root` is for a URDF named by an untrusted file. The mesh must then lie inside it after links are
// followed, or in a package of those two variables, which the user sets.
//
// std::runtime_error with one line that says where the file was searched, without the name of `urdf`.
std::filesystem::path FindMeshFile(const std::filesystem::path& urdf, const std::string& filename,
                                   const std::filesystem::path& root = {});

// Whether `file` lies in `folder` or below it, after links are followed.
[[nodiscard]] bool LiesIn(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace fovea::sim
