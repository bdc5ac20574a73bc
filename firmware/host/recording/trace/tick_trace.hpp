// The servo's ticks and their stages on a track. It stands where a tick is watched anyway, at its probe, its
// stages' probe and its recorder: a tick that is not traced runs the code that it always ran.
#pragma once

#include "firmware/core/task/stage_probe.hpp"
#include "firmware/host/recording/trace/trace.hpp"
#include "fovea/hal/clock.hpp"
#include "fovea/hal/feature.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::trace {

// Spans of one tick, at most: itself, its stages, and from the last of them to its end.
inline constexpr std::size_t kSpansPerTick = task::kStageNames.size() + 2;

// Reading the arm counts as the first stage's; writing it, and the record, are "write".
class TickTrace final : public hal::TickProbe, public task::StageProbe, public hal::Recorder {
 public:
  // All are borrowed; `probe` and `recorder` are asked as without it.
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
  std::int64_t picture_ = -1;  // that the tick took
};

// Each wait of a clock as a span.
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

// Each measurement on its way to the servo as an instant, in the thread that puts it.
class SinkTrace final : public hal::FeatureSink {
 public:
  SinkTrace(Track& track, hal::FeatureSink& sink) noexcept : track_(track), sink_(sink) {}
  void Put(const hal::FeatureMeasurement& measurement) noexcept override;

 private:
  Track& track_;
  hal::FeatureSink& sink_;
};

}  // namespace fovea::trace
