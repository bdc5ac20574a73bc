// SPDX-License-Identifier: Apache-2.0
// Reads a camera's own clock periodically while the camera streams, in its own thread.
//
// GenICam's names for it are TimestampLatch and TimestampLatchValue [ns] (SFNC 2), before that
// GevTimestampControlLatch and GevTimestampValue [ticks] (SFNC 1). Without both, the clock cannot be read.
#pragma once

#include <arv.h>

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "fovea/camera/latch_mapper.hpp"

namespace fovea::genicam {

class DeviceClock {
 public:
  // Starts to read the clock if the camera supports it. While this object exists, nobody else may use the
  // camera's features.
  explicit DeviceClock(ArvDevice* device);
  ~DeviceClock();
  DeviceClock(const DeviceClock&) = delete;
  DeviceClock& operator=(const DeviceClock&) = delete;

  // From any thread: the host's time of a camera stamp; none if there is no reading that is recent enough.
  [[nodiscard]] std::optional<std::int64_t> Map(std::int64_t device_ns) const;
  [[nodiscard]] double drift() const;

 private:
  struct Features {
    const char* latch;
    const char* value;
    bool in_ticks;
  };
  [[nodiscard]] static std::optional<Features> FeaturesOf(ArvDevice* device);
  void Run();
  [[nodiscard]] bool Ask();

  ArvDevice* const device_;
  const std::optional<Features> features_;
  double ns_per_tick_ = 1.0;
  mutable std::mutex mutex_;
  std::condition_variable closing_;
  bool closed_ = false;         // guarded by mutex_
  camera::LatchMapper mapper_;  // guarded by mutex_
  std::thread thread_;          // last: it uses the others
};

}  // namespace fovea::genicam
