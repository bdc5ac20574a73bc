// SPDX-License-Identifier: Apache-2.0
// A simulated camera that draws only what vision looks at, when it looks (hal::PixelMaker). Drawing is most
// of a simulation's work, and a tracker looks at a small part of each picture. Its pixels are those of
// SimCamera.
//
// It has no threads: the thread that acquires frames also draws. It has no automatic exposure, which needs
// whole pictures.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <vector>

#include "sim/camera/exposed_camera.hpp"
#include "sim/camera/sensor.hpp"
#include "sim/camera/sim_camera.hpp"

namespace fovea::sim {

class OnDemandCamera final : public ExposedCamera, private hal::PixelMaker {
 public:
  // Draws an exposure into an RGBA picture of the camera's size, top row first; only the pixels of `areas` if
  // there are any. May throw: the camera then reports a device fault and keeps the message.
  using Draw = std::function<void(const Exposure& exposure, std::span<const PictureArea> areas,
                                  std::span<std::uint8_t> rgba)>;

  // `leave_thread`: called on the thread that acquires, when the camera has closed or failed.
  // std::logic_error: the configuration has an automatic exposure.
  OnDemandCamera(const SimCameraConfig& config, Sensor sensor, Draw draw, std::function<void()> leave_thread);

  void Expose(Exposure exposure) override;
  void Close() override;
  [[nodiscard]] std::uint64_t lost() const override;
  [[nodiscard]] std::string fault() const override;

 private:
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;
  void Make(std::span<const hal::PixelArea> areas) noexcept override;

  const SimCameraConfig config_;
  const Sensor sensor_;
  const Draw draw_;
  const std::function<void()> leave_thread_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Exposure> waiting_;
  bool closed_ = false;
  std::uint64_t lost_ = 0;
  std::string fault_;

  // Of the frame that is out; used by the thread that acquires.
  Exposure shown_;
  std::vector<PictureArea> made_;
  std::vector<std::uint8_t> rgba_;
  std::vector<std::uint8_t> bgr_;
};

}  // namespace fovea::sim
