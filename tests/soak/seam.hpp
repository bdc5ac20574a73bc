// SPDX-License-Identifier: Apache-2.0
// The seam of a soak: wraps the simulated arm and clock, adds an offset of up to 292 years to the clock, and
// injects disturbances between them and the servo.
#pragma once

#include <cstdint>
#include <limits>

#include "fovea/hal/arm.hpp"
#include "fovea/hal/clock.hpp"
#include "fovea/hal/feature.hpp"
#include "tests/soak/trouble.hpp"

namespace fovea::soak {

// Initial values of clock and counters.
struct Start {
  std::int64_t clock_ns = 0;
  std::uint64_t tick = 0;
  std::uint64_t sequence = 0;  // of states and frames
};

// The present disturbance; one thread reads and writes it.
struct Acting {
  Trouble trouble = Trouble::kNone;
  int joint = 0;
  int stall_ticks = 0;  // the next wait ends this many ticks late
};

class SoakArm final : public hal::Arm {
 public:
  // All arguments must outlive the object.
  SoakArm(hal::Arm& arm, const Start& start, const Acting& acting)
      : Arm(arm.num_joints(), /*paces_loop=*/false), arm_(arm), start_(start), acting_(acting) {}

  [[nodiscard]] std::uint64_t silent_reads() const { return silent_reads_; }

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override {
    const hal::Status status = arm_.Read(state);
    if (acting_.trouble == Trouble::kSilence || acting_.trouble == Trouble::kLongSilence) {
      ++silent_reads_;
      return hal::Status(hal::StatusCode::kTimeout, "soak");
    }
    state.stamp_ns += start_.clock_ns;
    state.sequence += start_.sequence;
    if (acting_.trouble == Trouble::kNoNumber || acting_.trouble == Trouble::kNoNumberLong) {
      state.q[static_cast<std::size_t>(acting_.joint)] = std::numeric_limits<double>::quiet_NaN();
    }
    return status;
  }
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override { return arm_.Write(command); }

  hal::Arm& arm_;
  const Start& start_;
  const Acting& acting_;
  std::uint64_t silent_reads_ = 0;
};

class SoakClock final : public hal::Clock {
 public:
  SoakClock(hal::Clock& clock, const Start& start, Acting& acting)
      : clock_(clock), start_(start), acting_(acting) {}

  [[nodiscard]] std::uint64_t swallowed() const { return swallowed_; }

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return clock_.NowNs() + start_.clock_ns; }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    const int late = acting_.stall_ticks;
    acting_.stall_ticks = 0;
    swallowed_ += static_cast<std::uint64_t>(late);
    return clock_.WaitUntil(deadline_ns - start_.clock_ns + late * hal::kTickPeriodNs);
  }

  hal::Clock& clock_;
  const Start& start_;
  Acting& acting_;
  std::uint64_t swallowed_ = 0;
};

// Measurements on their way to the servo.
class SoakFeatures final : public hal::FeatureSink {
 public:
  SoakFeatures(hal::FeatureSink& sink, const Start& start, const Acting& acting)
      : sink_(sink), start_(start), acting_(acting) {}
  void Put(const hal::FeatureMeasurement& measurement) noexcept override {
    if (acting_.trouble == Trouble::kBlink || acting_.trouble == Trouble::kBlind) {
      return;
    }
    hal::FeatureMeasurement m = measurement;
    m.stamp_ns += start_.clock_ns;
    m.sequence += start_.sequence;
    if (acting_.trouble == Trouble::kWrongFeature) {
      m.s[0] += 0.5;
    } else if (acting_.trouble == Trouble::kNoFeature) {
      m.s[0] = std::numeric_limits<double>::quiet_NaN();
    }
    sink_.Put(m);
  }

 private:
  hal::FeatureSink& sink_;
  const Start& start_;
  const Acting& acting_;
};

}  // namespace fovea::soak
