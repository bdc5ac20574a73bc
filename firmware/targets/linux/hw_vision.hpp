// SPDX-License-Identifier: Apache-2.0
// Vision of the hardware target: camera and detector on their own thread, measurements to the servo.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "firmware/targets/linux/cameras/camera_driver.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "firmware/vision/detect/vision_task.hpp"

namespace fovea::hw {

// Image error of the target, as the camera sees it.
struct SeenError {
  std::uint64_t frames = 0;
  std::uint64_t frames_detected = 0;
  std::optional<double> last_px;     // distance from the goal in the newest picture with the target
  vision::FrameFailures failures{};  // frames that could not be processed; they count as not found
};

class HwVision {
 public:
  // Opens the camera and begins. CameraError, InputError. `features` must outlive it. `observer` may be
  // empty; the vision thread calls it.
  HwVision(const HwConfig& config, const features::TargetFeature& goal, std::int64_t start_ns,
           hal::FeatureSink& features, vision::FrameObserver observer);
  ~HwVision();

  // From any thread.
  [[nodiscard]] SeenError seen() const;
  // Why there are no more measurements; "" while the camera works, or after a normal end.
  [[nodiscard]] std::string failure() const;
  [[nodiscard]] std::string name() const { return camera_->name(); }

  // Ends the thread and returns the driver's counters.
  CameraCounters Finish();

 private:
  void Look(const vision::Detection& detection);

  const vision::Intrinsics intrinsics_;
  const model::Vec3 p_CO_C_star_;
  const std::unique_ptr<CameraDriver> camera_;
  vision::VisionTask task_;
  const vision::FrameObserver observer_;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  SeenError seen_;
  std::string failure_;
  int failed_in_a_row_ = 0;
  std::thread thread_;
};

}  // namespace fovea::hw
