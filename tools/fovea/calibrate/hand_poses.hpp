// Where the hand was at each picture: the file poses.csv, as `fovea calibrate hand-eye` reads it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/core/model/types.hpp"

namespace fovea {

struct HandPose {
  std::string file;  // of the picture
  model::Pose X_BE;
};

// One line for each picture, file,x,y,z,qw,qx,qy,qz [m, unit quaternion]; empty lines and those that begin
// with # say nothing. Throws config::InputError: no such file, or a line that is none of these.
std::vector<HandPose> ReadHandPoses(const std::filesystem::path& path);

}  // namespace fovea
