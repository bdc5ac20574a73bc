// Where the target really was in each frame that is still under way from the shutter to the detector.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>

namespace fovea::sim {

class TargetLog {
 public:
  // From the simulation's thread, before the camera hears of the exposure.
  void Put(std::uint64_t sequence, const Eigen::Vector3d& p_CO_C) {
    const std::lock_guard lock(mutex_);
    under_way_[sequence] = p_CO_C;
  }
  // From the vision thread, once for each frame that it got: the target's centre [m]. Frames before it, which
  // were lost, are forgotten.
  Eigen::Vector3d Take(std::uint64_t sequence) {
    const std::lock_guard lock(mutex_);
    const auto found = under_way_.find(sequence);
    const Eigen::Vector3d p_CO_C = found->second;
    under_way_.erase(under_way_.begin(), std::next(found));
    return p_CO_C;
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return under_way_.size();
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, Eigen::Vector3d> under_way_;
};

}  // namespace fovea::sim
