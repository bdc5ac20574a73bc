// SPDX-License-Identifier: Apache-2.0
// The way that the true camera takes in a run, to the millimetre.
#pragma once

#include <algorithm>
#include <vector>

#include "sim/world/world.hpp"

namespace fovea::sim {

class CameraPath {
 public:
  // `p_BC` [m]: where the camera is.
  void Add(const Eigen::Vector3d& p_BC) {
    if (points_.empty() || (p_BC - points_.back()).norm() >= kStep) {
      points_.push_back(p_BC);
    }
  }

  [[nodiscard]] double Length() const {  // [m]
    double length = 0.0;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      length += (points_[i] - points_[i - 1]).norm();
    }
    return length;
  }

  // The largest distance from the straight line between the way's ends [m].
  [[nodiscard]] double Excursion() const {
    double most = 0.0;
    if (points_.empty()) {
      return most;
    }
    const Eigen::Vector3d along = points_.back() - points_.front();
    const double length2 = along.squaredNorm();
    for (const Eigen::Vector3d& p : points_) {
      const double share =
          length2 > 0.0 ? std::clamp((p - points_.front()).dot(along) / length2, 0.0, 1.0) : 0.0;
      most = std::max(most, (p - points_.front() - share * along).norm());
    }
    return most;
  }

 private:
  static constexpr double kStep = 1e-3;  // [m]

  std::vector<Eigen::Vector3d> points_;
};

}  // namespace fovea::sim
