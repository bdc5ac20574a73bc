// Where the target really was in each frame that is still under way from the shutter to the detector.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>

#include "firmware/core/model/types.hpp"

namespace fovea::sim {

class TargetLog {
 public:
  // From the simulation's thread, before the camera hears of the exposure.
  void Put(std::uint64_t sequence, const model::Pose& X_CO) {
    const std::lock_guard lock(mutex_);
    under_way_[sequence] = X_CO;
  }
  // From the vision thread, once for each frame that it got: the target's pose X_CO. Frames before it, which
  // were lost, are forgotten.
  model::Pose Take(std::uint64_t sequence) {
    const std::lock_guard lock(mutex_);
    const auto found = under_way_.find(sequence);
    const model::Pose X_CO = found->second;
    under_way_.erase(under_way_.begin(), std::next(found));
    return X_CO;
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return under_way_.size();
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::uint64_t, model::Pose> under_way_;
};

}  // namespace fovea::sim
