// SPDX-License-Identifier: Apache-2.0
// The scenario's camera as a GigE Vision camera: sends the rendered pictures, with injected faults.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <semaphore>
#include <string>
#include <thread>

#include "fovea/linux_rt/bounded_ring.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/faults/picture_faults.hpp"
#include "sim/gige/camera.hpp"
#include "sim/run/eye.hpp"
#include "sim/run/watched_camera.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class NetworkEye {
 public:
  // `about` must outlive it; it must outlive the last step of `world`. With `lockstep` the world waits for
  // pictures that are due to leave. Without, the world never waits: another thread passes the exposures to
  // the threads that draw and send. `watcher` sees each picture before it is sent. std::runtime_error: this
  // computer cannot draw, or GigeCamera refuses.
  NetworkEye(const RunDescription& about, World& world, const std::string& address, const std::string& serial,
             bool lockstep, WatchedCamera::Watcher watcher = {});
  ~NetworkEye();

  // Call it after each step of the world, on the world's thread.
  void Advance();
  // Changes the faults of frames and pictures from the next exposure on. Call it on the world's thread.
  void SetFaults(const FaultSettings& faults);
  [[nodiscard]] std::uint64_t sent() const { return gige_->sent(); }
  // Exposures that were dropped before drawing. Call it on the world's thread, or after that has ended.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  // Why the camera failed; "" if it did not.
  [[nodiscard]] std::string fault() const { return eye_.camera().fault(); }

 private:
  // The events of one millisecond.
  struct News {
    std::int64_t now_ns = 0;
    std::int64_t late_ns = 0;  // additional delay of the exposure
    PictureFaults faults;      // of the exposure
    std::optional<Exposure> exposure;
  };
  void Take(const News& news, bool wait);
  void Run();

  World& world_;
  const bool lockstep_;
  Eye eye_;
  WatchedCamera watched_;
  FrameSpoiler faults_;
  const TrueStamps stamps_;
  std::unique_ptr<GigeCamera> gige_;
  News news_;                  // of the present millisecond; used by the world's thread
  std::uint64_t dropped_ = 0;  // used by the world's thread
  linux_rt::BoundedRing<News> on_the_way_;
  std::counting_semaphore<> there_{0};
  std::atomic<bool> closed_{false};
  std::thread courier_;  // declared last: it uses the other members
};

}  // namespace fovea::sim
