// The scenario's camera on the network: what the eye sees, as a GigE Vision camera sends it, with the
// faults that it has.
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
#include "sim/gige/camera.hpp"
#include "sim/run/eye.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class NetworkEye {
 public:
  // `about` must outlive it, and it must outlive what `world` does next. With `lockstep` the world waits for
  // pictures that are due to leave; without it, for nothing: a thread of the eye's own takes exposures to
  // those that draw and send them. std::runtime_error: no picture can be drawn here, or GigeCamera refuses.
  NetworkEye(const RunDescription& about, World& world, const std::string& address, const std::string& serial,
             bool lockstep);
  ~NetworkEye();

  // After each step of the world, by its thread.
  void Advance();
  [[nodiscard]] std::uint64_t sent() const { return gige_->sent(); }
  // Exposures that found no place on their way to those that draw them. By the world's thread, or after it.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  // Why there are no pictures any more; "" while there are.
  [[nodiscard]] std::string fault() const { return eye_.camera().fault(); }

 private:
  // What one millisecond brought.
  struct News {
    std::int64_t now_ns = 0;
    std::int64_t late_ns = 0;  // of the exposure
    std::optional<Exposure> exposure;
  };
  void Take(const News& news, bool wait);
  void Run();

  World& world_;
  const bool lockstep_;
  Eye eye_;
  FrameSpoiler faults_;
  std::unique_ptr<GigeCamera> gige_;
  News news_;                  // of the present millisecond; of the world's thread
  std::uint64_t dropped_ = 0;  // of the world's thread
  linux_rt::BoundedRing<News> on_the_way_;
  std::counting_semaphore<> there_{0};
  std::atomic<bool> closed_{false};
  std::thread courier_;  // last: it uses the others
};

}  // namespace fovea::sim
