// SPDX-License-Identifier: Apache-2.0
// Keeps each measurement until its modelled latency has passed, then passes it to the servo.
//
// The scenario sets the latency of exposure, read-out, transport and processing, independent of this
// computer. In lockstep, the world waits for a measurement that is due, so that a run does not depend on the
// speed of rendering and detection. In real time, a late measurement is passed on when it arrives.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "fovea/hal/feature.hpp"

namespace fovea::sim {

class FeatureDelay final : public hal::FeatureSink {
 public:
  // Called by the vision thread.
  void Put(const hal::FeatureMeasurement& measurement) noexcept override;

  // Announces frame `sequence`, whose measurement is due at `due_ns`. Called by the simulation's thread.
  void Expect(std::uint64_t sequence, std::int64_t due_ns);
  // Passes all measurements due at `now_ns` to `servo`. With `wait`, waits for those that are due. Returns
  // false if a due measurement is missing and the vision side is closed.
  bool HandOver(std::int64_t now_ns, bool wait, hal::FeatureSink& servo);

  // Announces that no measurement will follow. Called by any thread.
  void Close();

 private:
  struct Expected {
    std::uint64_t sequence = 0;
    std::int64_t due_ns = 0;
    std::optional<hal::FeatureMeasurement> measurement;
  };

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Expected> expected_;  // in order of exposure
  bool closed_ = false;
};

}  // namespace fovea::sim
