// SPDX-License-Identifier: Apache-2.0
// Distance between an arm's links, by capsules around their collision shapes.
#pragma once

#include <vector>

#include "sim/robot/chain.hpp"

namespace fovea::sim {

class SelfDistance {
 public:
  // Uses the cylinders and spheres of `robot`; ignores boxes and meshes. Skips pairs of links with at most
  // two joints between them: these are always close.
  explicit SelfDistance(const SimRobot& robot);

  // The least gap between two links [m]; negative: they overlap. `X_BL`: poses of the links' frames.
  [[nodiscard]] double Least(const std::vector<Eigen::Isometry3d>& X_BL) const;

 private:
  struct Capsule {
    std::size_t link = 0;
    std::size_t rank = 0;  // moving joints between the base and its link
    Eigen::Vector3d a_L, b_L;
    double radius = 0.0;
  };
  std::vector<Capsule> capsules_;
};

}  // namespace fovea::sim
