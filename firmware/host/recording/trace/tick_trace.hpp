// SPDX-License-Identifier: Apache-2.0
// Traces the servo's ticks and their stages on a track. It uses the existing hooks of a tick: its probe, its
// stages' probe and its recorder. So a tick without trace runs unchanged code.
#pragma once

#include "firmware/core/task/stage_probe.hpp"
#include "firmware/host/recording/trace/trace.hpp"
#include "fovea/hal/clock.hpp"
#include "fovea/hal/feature.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::trace {

// The most spans of one tick: the tick, its stages, and the rest from the last stage to the tick's end.
inline constexpr std::size_t kSpansPerTick = task::kStageNames.size() + 2;

// Reading the arm belongs to the first stage; writing to the arm and recording are "write".
class TickTrace final : public hal::TickProbe, public task::StageProbe, public hal::Recorder {
 public:
  // Borrows all; forwards every call to `probe` and `recorder`.
  TickTrace(Track& track, hal::TickProbe& probe, hal::Recorder& recorder) noexcept
      : track_(track), probe_(probe), recorder_(recorder) {}

  void Enter() noexcept override;
  void Leave() noexcept override;
  void MarkStageEnd(task::Stage stage) noexcept override;
  void Record(const hal::TickRecord& record) noexcept override;

 private:
  Track& track_;
  hal::TickProbe& probe_;
  hal::Recorder& recorder_;
  std::int64_t begin_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::int64_t tick_ = -1;
  std::int64_t picture_ = -1;  // whose measurement the tick took; -1: none
};

// Traces each wait of a clock as a span.
class ClockTrace final : public hal::Clock {
 public:
  ClockTrace(Track& track, hal::Clock& clock, const char* name) noexcept
      : track_(track), clock_(clock), name_(name) {}

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return clock_.NowNs(); }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override;

  Track& track_;
  hal::Clock& clock_;
  const char* name_;
};

// Traces each measurement that goes to the servo as an instant, in the thread that puts it.
class SinkTrace final : public hal::FeatureSink {
 public:
  SinkTrace(Track& track, hal::FeatureSink& sink) noexcept : track_(track), sink_(sink) {}
  void Put(const hal::FeatureMeasurement& measurement) noexcept override;

 private:
  Track& track_;
  hal::FeatureSink& sink_;
};

}  // namespace fovea::trace
