// From picture to torque by the clock: a camera whose pictures come when a real one's would, the detector
// that looks at them in a thread of its own, and when each of them came how far.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <thread>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::bench {

// The camera of the benchmark: 640x480 pixels of 8 bits, 30 Hz.
inline constexpr std::int64_t kExposureNs = 5'000'000;
inline constexpr std::int64_t kReadOutNs = 3'000'000;  // from the shutter's close to the host, at 1 Gbit/s

// One picture on its way, in CLOCK_MONOTONIC [ns]; 0 where it did not come so far.
struct HopTimes {
  std::int64_t stamp_ns = 0;     // middle of the exposure
  std::int64_t arrived_ns = 0;   // the vision thread has the picture
  std::int64_t detected_ns = 0;  // its measurement lies in the mailbox
  std::int64_t woken_ns = 0;     // the tick that took it began
  std::int64_t written_ns = 0;   // and wrote its torques
};

class EyeChain {
 public:
  // Draws pictures of a ball at the goal of `config`, as a camera sees them whose arm stands still there, and
  // keeps the times of at most `pictures` of them.
  EyeChain(const config::ServoConfig& config, std::size_t pictures);
  ~EyeChain();
  EyeChain(const EyeChain&) = delete;
  EyeChain& operator=(const EyeChain&) = delete;

  // Takes pictures from now on.
  void Start();
  // Takes no more, and waits for the thread.
  void Stop();

  [[nodiscard]] hal::FeatureMailbox& mailbox() { return mailbox_; }
  // From the servo's thread: a tick took the measurement of picture `sequence`. Real-time: yes.
  void NoteUse(std::uint64_t sequence, std::int64_t woken_ns, std::int64_t written_ns) noexcept;

  // After Stop: the pictures that came as far as the vision thread.
  [[nodiscard]] std::vector<HopTimes> Hops() const;

 private:
  class Camera;
  class Sink;
  struct Use {
    std::int64_t woken_ns = 0;
    std::int64_t written_ns = 0;
  };

  const config::ServoConfig& config_;
  std::vector<cv::Mat> pictures_;
  std::vector<HopTimes> seen_;  // by sequence; the vision thread's
  std::vector<Use> used_;       // by sequence; the servo's
  hal::FeatureMailbox mailbox_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace fovea::bench
