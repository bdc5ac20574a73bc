// SPDX-License-Identifier: Apache-2.0
// A camera behind Video4Linux2, such as a USB camera. Tested against a scripted device; not tried on
// hardware.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "fovea/camera/frame_counter.hpp"
#include "fovea/hal/camera.hpp"
#include "fovea/v4l2/device.hpp"

namespace fovea::v4l2 {

struct V4l2Config {
  std::string path = "/dev/video0";
  int width_px = 640;
  int height_px = 480;
  std::string pixel_format;  // Mono8, BayerRG8, ..., YUYV, RGB8, BGR8; empty: as the device is set
  double rate_hz = 0.0;      // 0: as the device is set
  double exposure_us = 0.0;  // 0: as the device is set, and assumed 0 for stamps
  int gain = -1;             // in the device's unit; negative: as the device is set
  // The kernel stamps frames at the start of the exposure or at the end of the read-out, and says which. This
  // is the time from the end of the exposure to the end of the read-out.
  std::int64_t transport_ns = 0;
  bool reconnect = true;  // after an unplug, search for the device until it is back
};

struct V4l2Counters {
  std::uint64_t frames = 0;
  std::uint64_t incomplete = 0;  // frames that the kernel marks as damaged, or that are too short
  std::uint64_t lost = 0;        // by gaps in their numbers
  std::uint64_t overtaken = 0;   // complete, but a newer one had already arrived
  std::uint64_t disconnects = 0;
  std::uint64_t reconnects = 0;
};

class V4l2Camera final : public hal::Camera {
 public:
  // Opens, sets up and starts the camera. CameraError: not found, in use, or it refuses a setting.
  explicit V4l2Camera(const V4l2Config& config, std::unique_ptr<Device> device = MakeSystemDevice());
  ~V4l2Camera();

  // From the acquiring thread: Acquire still delivers waiting frames, then returns kClosed.
  void Close() { closed_ = true; }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const V4l2Counters& counters() const { return counters_; }

 private:
  class Session;

  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;
  [[nodiscard]] hal::Status Take(hal::Frame& frame, std::int64_t timeout_ns);
  [[nodiscard]] bool Reopen(std::int64_t timeout_ns);

  const V4l2Config config_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<Session> session_;  // null: the device is disconnected
  std::string name_;
  cv::Mat picture_;
  camera::FrameCounter numbers_{0, UINT32_MAX};
  std::int64_t next_look_ns_ = 0;
  bool closed_ = false;
  V4l2Counters counters_;
};

}  // namespace fovea::v4l2
