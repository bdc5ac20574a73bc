// SPDX-License-Identifier: Apache-2.0
// The hand's pose at each picture, from the file poses.csv, for `fovea calibrate hand-eye`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/core/model/types.hpp"

namespace fovea {

struct HandPose {
  std::string file;  // name of the picture
  model::Pose X_BE;
};

// One line for each picture: file,x,y,z,qw,qx,qy,qz [m, unit quaternion]. Empty lines and lines that begin
// with # are ignored. Throws config::InputError when the file does not exist or has another line.
std::vector<HandPose> ReadHandPoses(const std::filesystem::path& path);

}  // namespace fovea
