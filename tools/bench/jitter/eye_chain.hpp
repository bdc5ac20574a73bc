// SPDX-License-Identifier: Apache-2.0
// From picture to torque in real time: a camera with the timing of a real one, the detector in its own
// thread, and the times at which each picture reached each step.
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
inline constexpr std::int64_t kReadOutNs = 3'000'000;  // from the end of exposure to the host, at 1 Gbit/s

// Times of one picture in CLOCK_MONOTONIC [ns]; 0: the picture did not reach this step.
struct HopTimes {
  std::int64_t stamp_ns = 0;     // middle of the exposure
  std::int64_t arrived_ns = 0;   // the vision thread has the picture
  std::int64_t detected_ns = 0;  // its measurement is in the mailbox
  std::int64_t woken_ns = 0;     // the tick that took the measurement began
  std::int64_t written_ns = 0;   // this tick wrote its torques
};

class EyeChain {
 public:
  // Draws pictures of a ball as the camera sees it while the arm stands still at the goal of `config`. Stores
  // the times of at most `pictures` pictures.
  EyeChain(const config::ServoConfig& config, std::size_t pictures);
  ~EyeChain();
  EyeChain(const EyeChain&) = delete;
  EyeChain& operator=(const EyeChain&) = delete;

  // Starts the vision thread, which takes pictures from now on.
  void Start();
  // Stops the vision thread and waits for its end.
  void Stop();

  [[nodiscard]] hal::FeatureMailbox& mailbox() { return mailbox_; }
  // The servo's thread calls this when a tick took the measurement of picture `sequence`. Real-time: yes.
  void NoteUse(std::uint64_t sequence, std::int64_t woken_ns, std::int64_t written_ns) noexcept;

  // Call it after Stop. The pictures that reached the vision thread.
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
  std::vector<HopTimes> seen_;  // by sequence; written by the vision thread
  std::vector<Use> used_;       // by sequence; written by the servo's thread
  hal::FeatureMailbox mailbox_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace fovea::bench
