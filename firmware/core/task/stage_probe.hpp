// SPDX-License-Identifier: Apache-2.0
// Measures the time of each stage of a tick.
#pragma once

#include <array>
#include <cstdint>

namespace fovea::task {

// In the order of ServoTask::Step.
enum class Stage : std::uint8_t {
  kCheck,
  kModel,
  kContact,
  kPredict,
  kModes,
  kVisualLaw,
  kReference,  // limits, guard, commanded motions
  kMotionLaw,
  kClamp,
  kRecord,
};
inline constexpr std::array<const char*, 10> kStageNames{"check", "model",      "contact",   "predict",
                                                         "modes", "visual_law", "reference", "motion_law",
                                                         "clamp", "record"};

// Told at the end of each stage of a tick, by the thread that runs it. Real-time: yes.
class StageProbe {
 public:
  StageProbe(const StageProbe&) = delete;
  StageProbe& operator=(const StageProbe&) = delete;
  virtual void MarkStageEnd(Stage stage) noexcept = 0;

 protected:
  StageProbe() noexcept = default;
  ~StageProbe() = default;
};

}  // namespace fovea::task
