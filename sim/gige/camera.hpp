// SPDX-License-Identifier: Apache-2.0
// The simulated camera on the network: a GigE Vision camera, built on Aravis' fake camera.
//
// A picture is sent when the world's time reaches its stamp plus its transport time. GigE Vision's control
// port is fixed (UDP 3956), so an address can have only one such camera.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>

#include "fovea/hal/camera.hpp"

namespace fovea::sim {

struct GigeCameraConfig {
  std::string address = "127.0.0.1";  // of an interface of this computer
  std::string serial = "fovea";       // 1 to 15 characters
  int width_px = 640;
  int height_px = 480;
  double rate_hz = 30.0;
  std::int64_t exposure_ns = 5'000'000;
  std::int64_t transport_ns = 40'000'000;  // from the stamp until the picture is sent
};

class GigeCamera {
 public:
  // `eye` supplies the pictures (BGR8, of the configured size) and must outlive this. std::runtime_error: the
  // address is not of this computer, the port is in use, or the serial number is empty or too long.
  GigeCamera(hal::Camera& eye, const GigeCameraConfig& config);
  ~GigeCamera();

  // Announces an exposure of `stamp_ns`. Returns whether a client is streaming; only then the caller exposes.
  // The picture leaves `late_ns` later than usual; the next ones wait for it. Called by the world's thread.
  [[nodiscard]] bool Expect(std::int64_t stamp_ns, std::int64_t late_ns = 0);
  // Sets the world's time to `now_ns`; pictures that are due may leave. With `wait`, and while a client is
  // streaming, returns when they have left; drops them after two seconds. Called by the world's thread.
  void Advance(std::int64_t now_ns, bool wait);

  [[nodiscard]] bool streaming() const;
  [[nodiscard]] std::uint64_t sent() const;

 private:
  struct Aravis;

  // Fills the buffer that Aravis sends next; called by its thread.
  void Fill(void* buffer, std::uint32_t pixel_format);
  [[nodiscard]] bool TakeDue(std::unique_lock<std::mutex>& lock);
  [[nodiscard]] bool IsDue() const;

  hal::Camera& eye_;
  const GigeCameraConfig config_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  std::int64_t now_ns_ = 0;
  struct Expected {
    std::int64_t stamp_ns = 0;
    std::int64_t due_ns = 0;
  };
  std::deque<Expected> expected_;  // not sent yet, oldest first
  std::uint64_t sent_ = 0;
  hal::Frame frame_;                // the last frame from eye_
  bool on_its_way_ = false;         // Aravis is sending frame_
  std::unique_ptr<Aravis> aravis_;  // declared last: its thread uses all members above
};

}  // namespace fovea::sim
