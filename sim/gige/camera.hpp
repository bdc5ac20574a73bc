// The simulated camera on the network: a GigE Vision camera, by Aravis' own stand-in for one.
//
// A picture leaves when it is due: the world says what its time is, and a frame waits until its transport is
// over. GigE Vision's control port is fixed (UDP 3956), so one such camera lives at an address.
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
  std::int64_t transport_ns = 40'000'000;  // from the stamp until the picture leaves
};

class GigeCamera {
 public:
  // `eye` gives the pictures (BGR8, of that size) and outlives this. std::runtime_error: the address is none
  // of this computer's, the port is taken, or the serial number is empty or too long.
  GigeCamera(hal::Camera& eye, const GigeCameraConfig& config);
  ~GigeCamera();

  // From the thread that advances the world: the eye gets an exposure, when this says that somebody wants it.
  // It leaves `late_ns` later than others; those behind it wait.
  [[nodiscard]] bool Expect(std::int64_t stamp_ns, std::int64_t late_ns = 0);
  // From the same: the world's time is `now_ns`, and what is due may leave. With `wait`, and while somebody
  // takes the pictures, returns when all that is due has left; after two seconds what has not is given up.
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
  std::deque<Expected> expected_;  // what has not left yet, oldest first
  std::uint64_t sent_ = 0;
  hal::Frame frame_;                // the last one that was taken from the eye
  bool on_its_way_ = false;         // frame_ was filled in, and leaves
  std::unique_ptr<Aravis> aravis_;  // last: its thread uses all of the above
};

}  // namespace fovea::sim
