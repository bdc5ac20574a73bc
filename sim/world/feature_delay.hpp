// Keeps each measurement until its modelled latency has passed, then hands it to the servo.
//
// The latency of exposure, read-out, transport and processing is a figure of the scenario, not of this
// computer. In lockstep the world waits for a measurement that is due and not there yet, so that a run does
// not depend on how fast rendering and detection were; in real time it does not wait, and a late measurement
// is handed over when it comes.
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
  // From the vision thread.
  void Put(const hal::FeatureMeasurement& measurement) noexcept override;

  // From the simulation's thread: frame `sequence` was exposed; its measurement is due at `due_ns`.
  void Expect(std::uint64_t sequence, std::int64_t due_ns);
  // Hands over all that is due at `now_ns`. With `wait`, first waits for those which are due; returns false
  // when the vision side was closed while it waited.
  bool HandOver(std::int64_t now_ns, bool wait, hal::FeatureSink& servo);

  // From any thread: nothing more will be put.
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
