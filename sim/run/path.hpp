// SPDX-License-Identifier: Apache-2.0
// A path for a picture: points evenly spaced in time, at most as many as a picture can show.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fovea::sim {

class Path {
 public:
  // Adds a point, in order of time. Keeps only as many points as the picture needs.
  void Add(std::int64_t stamp_ns, const Eigen::Vector3d& p_B) {
    if (stamp_ns < next_ns_) {
      return;
    }
    points_.push_back(p_B);
    if (points_.size() > kMostPoints) {
      for (std::size_t i = 0; 2 * i < points_.size(); ++i) {
        points_[i] = points_[2 * i];
      }
      points_.resize((points_.size() + 1) / 2);
      step_ns_ *= 2;
    }
    next_ns_ = stamp_ns + step_ns_;
  }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& points() const { return points_; }

 private:
  static constexpr std::size_t kMostPoints = 4000;  // even, so that halving keeps the newest point
  std::int64_t step_ns_ = 16'000'000;  // least time between points; doubled when there are too many
  std::int64_t next_ns_ = 0;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace fovea::sim
