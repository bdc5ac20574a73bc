// SPDX-License-Identifier: Apache-2.0
#include "fovea/hal/feature.hpp"

namespace fovea::hal {

void FeatureMailbox::Put(const FeatureMeasurement& measurement) noexcept {
  slots_[write_slot_] = measurement;
  // Release: the slot's content is visible before its number is. Acquire: the reader is done with the slot
  // that comes back.
  const auto offered = static_cast<std::uint8_t>(write_slot_ | kFresh);
  const std::uint8_t returned = middle_.exchange(offered, std::memory_order_acq_rel);
  write_slot_ = returned & kSlotMask;
}

bool FeatureMailbox::Take(FeatureMeasurement& measurement) noexcept {
  if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) {
    return false;
  }
  const std::uint8_t taken = middle_.exchange(read_slot_, std::memory_order_acq_rel);
  read_slot_ = taken & kSlotMask;
  measurement = slots_[read_slot_];
  return true;
}

}  // namespace fovea::hal
