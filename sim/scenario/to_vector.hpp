// SPDX-License-Identifier: Apache-2.0
// A key's list of numbers as a vector.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fovea::sim {

inline Eigen::Vector3d ToVector(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }
inline Eigen::VectorXd ToVectorX(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

}  // namespace fovea::sim
