// SPDX-License-Identifier: Apache-2.0
// Keeps the target's true pose for each frame between its exposure and its detection.
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
  // Called by the simulation's thread, before the camera gets the exposure.
  void Put(std::uint64_t sequence, const model::Pose& X_CO) {
    const std::lock_guard lock(mutex_);
    under_way_[sequence] = X_CO;
  }
  // Returns the target's pose X_CO for a frame. Called by the vision thread, once per received frame. Removes
  // all earlier frames, which were lost.
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
