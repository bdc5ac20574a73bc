// The simulated camera behind the seam: exposures of the world go in, frames come out.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "fovea/hal/camera.hpp"
#include "sim/camera/sensor.hpp"
#include "sim/render/exposure.hpp"

namespace fovea::sim {

// Draws an exposure into an RGBA picture of the camera's size, top row first. Called by the thread that
// acquires. May throw: the camera then reports a device fault and keeps the message.
using DrawExposure = std::function<void(const Exposure& exposure, std::span<std::uint8_t> rgba)>;

class SimCamera final : public hal::Camera {
 public:
  // Most exposures that wait to be drawn; when more come, the oldest is lost, as in a real camera.
  static constexpr std::size_t kQueue = 8;

  SimCamera(int width_px, int height_px, std::int64_t exposure_ns, Sensor sensor, DrawExposure draw);

  // From the simulation's thread.
  void Expose(Exposure exposure);
  void Close();

  [[nodiscard]] std::uint64_t lost() const;
  // Why the camera is in a device fault; "" when it is not.
  [[nodiscard]] std::string fault() const;

 private:
  hal::Status DoAcquire(hal::Frame& frame, std::int64_t timeout_ns) noexcept override;

  const int width_px_;
  const int height_px_;
  const std::int64_t exposure_ns_;
  const Sensor sensor_;
  const DrawExposure draw_;
  std::vector<std::uint8_t> rgba_;
  std::vector<std::uint8_t> bgr_;

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Exposure> waiting_;
  bool closed_ = false;
  std::uint64_t lost_ = 0;
  std::string fault_;
};

}  // namespace fovea::sim
