// The simulated camera behind the seam: exposures of the world go in, frames come out, in order.
//
// Drawing a picture is the most that a simulation computes, and one picture does not depend on another: each
// of a few worker threads draws one, and the frames are handed out in the order of their exposure.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "fovea/hal/camera.hpp"
#include "sim/camera/sensor.hpp"
#include "sim/render/exposure.hpp"

namespace fovea::sim {

// What draws an exposure. All functions are called by one and the same thread.
struct Painter {
  // Into an RGBA picture of the camera's size, top row first. May throw: the camera then reports a device
  // fault and keeps the message.
  std::function<void(const Exposure& exposure, std::span<std::uint8_t> rgba)> draw;
  // The sensor has made its picture of it; may be empty.
  std::function<void()> picture_done = nullptr;
  // The thread is about to end; may be empty.
  std::function<void()> leave_thread = nullptr;
};

struct SimCameraConfig {
  int width_px = 640;
  int height_px = 480;
  std::int64_t exposure_ns = 5'000'000;
  // Exposures that may wait to be drawn and taken; when more come, the oldest is lost, as in a real camera.
  std::size_t queue = 2;
};

class SimCamera final : public hal::Camera {
 public:
  // One worker thread for each painter.
  SimCamera(const SimCameraConfig& config, Sensor sensor, std::vector<Painter> painters);
  ~SimCamera();

  // From the simulation's thread.
  void Expose(Exposure exposure);
  // From any thread: no exposure will follow. What was exposed is still drawn and handed out; then Acquire
  // answers kClosed.
  void Close();

  [[nodiscard]] std::uint64_t lost() const;
  // Why the camera is in a device fault; "" when it is not.
  [[nodiscard]] std::string fault() const;

 private:
  enum class Progress { kWaiting, kDrawing, kDone };
  struct Job {
    Exposure exposure;
    Progress progress = Progress::kWaiting;
    std::vector<std::uint8_t> bgr;
  };

  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;
  void LoseOldest();
  void Work(const Painter& painter);
  void DrawUntilClosed(const Painter& painter);
  [[nodiscard]] std::shared_ptr<Job> NextWaiting() const;

  const SimCameraConfig config_;
  const Sensor sensor_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Job>> jobs_;                 // in order of exposure
  std::vector<std::vector<std::uint8_t>> spare_buffers_;  // reused
  std::vector<std::uint8_t> handed_out_;                  // the pixels of the last frame
  bool closed_ = false;
  std::uint64_t lost_ = 0;
  std::string fault_;
  std::vector<std::thread> workers_;
};

}  // namespace fovea::sim
