// SPDX-License-Identifier: Apache-2.0
// The vision of a simulated run, from an exposure to a measurement that is due: rendered camera, vision task
// on its own thread, faults of frames and detector, and the modelled latency.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "firmware/vision/detect/vision_task.hpp"
#include "sim/faults/faulty_detector.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/run/eye.hpp"
#include "sim/run/trace.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/verdict/target_log.hpp"
#include "sim/world/feature_delay.hpp"

namespace fovea::sim {

class SimVision {
 public:
  // Called by the vision thread for each frame. `X_CO`: the target's true pose.
  using Observer = std::function<void(const hal::Frame& frame, const vision::Detection& detection,
                                      const model::Pose& X_CO)>;

  // `about` must outlive it. InputError: the detector cannot be set up as [vision] demands.
  SimVision(const RunDescription& about, Observer observer);
  ~SimVision();
  SimVision(const SimVision&) = delete;
  SimVision& operator=(const SimVision&) = delete;

  // Opens the camera; call it only if the scenario has one. InputError, std::runtime_error: this computer
  // cannot draw it.
  void Open(const EyeOptions& options);
  // Starts the vision thread. Call it after Open.
  void Begin();
  // Closes the camera and waits for the vision thread, if it runs.
  void End();

  // Takes an exposure. False if the frame is lost. Called by the world's thread.
  bool Expose(const Exposure& exposure);
  // Changes the faults of frames, pictures and detector from the next exposure on. Called by the world's
  // thread.
  void SetFaults(const FaultSettings& faults);
  // Passes due measurements to `servo`; see FeatureDelay.
  bool HandOver(std::int64_t now_ns, bool wait, hal::FeatureSink& servo) {
    return delay_.HandOver(now_ns, wait, servo);
  }

  // Rethrows an exception of the vision thread; std::runtime_error: the camera failed. Call this and the
  // functions below only after End.
  void RethrowFailure() const;
  [[nodiscard]] const vision::FrameFailures& failures() const { return task_.failures(); }
  // Frames that never reached vision: those that Expose lost, and those that the camera dropped.
  [[nodiscard]] std::uint64_t frames_lost() const {
    return lost_on_purpose_ + (eye_ ? eye_->camera().lost() : 0);
  }
  // Name of the renderer; "nothing" without a camera.
  [[nodiscard]] std::string renderer() const { return eye_ ? eye_->driver_name() : "nothing"; }

 private:
  void Run();

  const RunDescription& about_;
  const Observer observer_;
  vision::VisionTask task_;
  std::int64_t arrived_ns_ = 0;  // when the newest picture arrives, without faults
  FeatureDelay delay_;
  FaultyDetector detector_;
  FrameSpoiler frame_faults_;
  std::uint64_t lost_on_purpose_ = 0;
  TargetLog targets_;
  RunTrace* trace_ = nullptr;
  std::optional<Eye> eye_;
  const std::atomic<bool> never_stop_{false};  // the thread ends when the camera closes
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace fovea::sim
