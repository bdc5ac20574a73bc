// SPDX-License-Identifier: Apache-2.0
// Faults that the simulation's thread changes while others read them.
#pragma once

#include <mutex>

namespace fovea::sim {

template <class Faults>
class SharedFaults {
 public:
  explicit SharedFaults(const Faults& faults) : faults_(faults) {}

  [[nodiscard]] Faults Get() const {
    const std::lock_guard lock(mutex_);
    return faults_;
  }
  void Set(const Faults& faults) {
    const std::lock_guard lock(mutex_);
    faults_ = faults;
  }

 private:
  mutable std::mutex mutex_;
  Faults faults_;
};

}  // namespace fovea::sim
