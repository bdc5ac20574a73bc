// SPDX-License-Identifier: Apache-2.0
// Reads the servo's mode from the tick records that pass through, for the code that advances the world.
#pragma once

#include "fovea/hal/record.hpp"

namespace fovea::sim {

// Used by the thread that runs the loop.
class ModeWatch final : public hal::Recorder {
 public:
  void PassTo(hal::Recorder& next) { next_ = &next; }  // borrowed
  void Record(const hal::TickRecord& record) noexcept override {
    mode_ = record.mode;
    next_->Record(record);
  }
  // The mode of the last tick.
  [[nodiscard]] hal::Mode mode() const { return mode_; }

 private:
  hal::Recorder* next_ = nullptr;
  hal::Mode mode_ = hal::Mode::kBoot;
};

}  // namespace fovea::sim
