// SPDX-License-Identifier: Apache-2.0
// The simulated camera as a hal::Camera: takes exposures of the world, delivers frames in the same order.
//
// Drawing the pictures is most of a simulation's work, and pictures are independent. Several worker threads
// draw one picture each; frames are delivered in the order of their exposures.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "fovea/hal/camera.hpp"
#include "sim/camera/auto_exposure.hpp"
#include "sim/camera/exposed_camera.hpp"
#include "sim/camera/sensor.hpp"
#include "sim/render/exposure.hpp"

namespace fovea::sim {

// Draws exposures. One thread calls all functions of a painter.
struct Painter {
  // Draws into an RGBA picture of the camera's size, top row first. May throw: the camera then reports a
  // device fault and keeps the message.
  std::function<void(const Exposure& exposure, std::span<std::uint8_t> rgba)> draw;
  // Called after the sensor has made its picture; may be empty.
  std::function<void()> picture_done = nullptr;
  // Called before the thread ends; may be empty.
  std::function<void()> leave_thread = nullptr;
};

struct SimCameraConfig {
  int width_px = 640;
  int height_px = 480;
  std::int64_t exposure_ns = 5'000'000;
  // Largest number of exposures that wait. The next one then drops the oldest, as in a real camera.
  std::size_t queue = 2;
  AutoExposureConfig auto_exposure{};
};

class SimCamera final : public ExposedCamera {
 public:
  // One worker thread for each painter.
  SimCamera(const SimCameraConfig& config, Sensor sensor, std::vector<Painter> painters);
  ~SimCamera() override;

  void Expose(Exposure exposure) override;
  void Close() override;
  [[nodiscard]] std::uint64_t lost() const override;
  [[nodiscard]] std::string fault() const override;

 private:
  enum class Progress { kWaiting, kDrawing, kDone };
  // Pictures with the same frozen pixels also have the same gain: that of the first one.
  struct FrozenGain {
    std::uint64_t sequence = 0;  // of the frame that the pixels come from
    std::optional<double> gain;  // none: not known yet
  };
  struct Job {
    Exposure exposure;
    std::uint64_t index = 0;  // counts the calls of Expose
    Progress progress = Progress::kWaiting;
    std::vector<std::uint8_t> bgr;
    std::shared_ptr<FrozenGain> frozen_gain;  // null: its pixels are its own
  };

  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;
  void LoseOldest();
  void Work(const Painter& painter);
  void DrawUntilClosed(const Painter& painter);
  [[nodiscard]] std::shared_ptr<Job> NextWaiting() const;
  double WaitForGain(const Job& job);
  [[nodiscard]] std::optional<double> TakeGain(const Job& job);

  const SimCameraConfig config_;
  const Sensor sensor_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Job>> jobs_;                 // in order of exposure
  std::vector<std::vector<std::uint8_t>> spare_buffers_;  // reused
  std::vector<std::uint8_t> handed_out_;                  // the pixels of the last frame
  AutoExposure auto_exposure_;
  std::shared_ptr<FrozenGain> frozen_gain_;  // of the last exposure
  std::uint64_t exposed_ = 0;
  bool closed_ = false;
  std::uint64_t lost_ = 0;
  std::string fault_;
  std::vector<std::thread> workers_;
};

}  // namespace fovea::sim
