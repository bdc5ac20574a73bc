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
  double exposure_us = 0.0;  // 0: as the device is set, and then taken for 0
  int gain = -1;             // in the device's unit; negative: as the device is set
  // The kernel stamps frames at the start of the exposure or at the end of the read-out, and says which; this
  // is the time from the exposure's end until the latter.
  std::int64_t transport_ns = 0;
  bool reconnect = true;  // after an unplug, look for the device until it is there again
};

struct V4l2Counters {
  std::uint64_t frames = 0;
  std::uint64_t incomplete = 0;  // frames that the kernel marks as damaged, or that are too short
  std::uint64_t lost = 0;        // by their numbers
  std::uint64_t overtaken = 0;   // whole, but a newer one was there already
  std::uint64_t disconnects = 0;
  std::uint64_t reconnects = 0;
};

class V4l2Camera final : public hal::Camera {
 public:
  // Opens, sets up and starts. CameraError: there is none, it is in use, or it refuses a setting.
  explicit V4l2Camera(const V4l2Config& config, std::unique_ptr<Device> device = MakeSystemDevice());
  ~V4l2Camera();

  // From the thread that acquires: it still hands out what waits, then answers kClosed.
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
  std::unique_ptr<Session> session_;  // null: the device is away
  std::string name_;
  cv::Mat picture_;
  camera::FrameCounter numbers_{0, UINT32_MAX};
  std::int64_t next_look_ns_ = 0;
  bool closed_ = false;
  V4l2Counters counters_;
};

}  // namespace fovea::v4l2
