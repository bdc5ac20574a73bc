// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/calibrate/hand_poses.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "firmware/host/config/input_error.hpp"

namespace fovea {

std::vector<HandPose> ReadHandPoses(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) {
    throw config::InputError(path.string() +
                             ": no such file; it needs one line file,x,y,z,qw,qx,qy,qz for each image");
  }
  std::vector<HandPose> poses;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (line.empty() || line[0] == '#') {
      continue;
    }
    std::istringstream fields(line);
    std::string file;
    std::getline(fields, file, ',');
    std::array<double, 7> v{};
    bool good = true;
    for (double& value : v) {
      std::string field;
      good = good && std::getline(fields, field, ',') && (std::istringstream(field) >> value) &&
             std::isfinite(value);
    }
    const Eigen::Quaterniond q(v[3], v[4], v[5], v[6]);
    if (!good || std::fabs(q.norm() - 1.0) > 1e-3) {
      throw config::InputError(
          fmt::format("{}:{}: must be file,x,y,z,qw,qx,qy,qz with a unit quaternion", path.string(), number));
    }
    poses.push_back({file, {q.normalized().toRotationMatrix(), {v[0], v[1], v[2]}}});
  }
  return poses;
}

}  // namespace fovea
