// How near an arm's links come to each other: the capsules about their collision shapes.
#pragma once

#include <vector>

#include "sim/robot/chain.hpp"

namespace fovea::sim {

class SelfDistance {
 public:
  // Cylinders and spheres of `robot` count; boxes and meshes do not. Links that are joined, or have one link
  // between them, cannot but be near, and are not looked at.
  explicit SelfDistance(const SimRobot& robot);

  // The least gap between two links when the links' frames are at `X_BL` [m]; negative: they overlap.
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
