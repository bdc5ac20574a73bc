// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/jitter/timed_loop.hpp"

#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "firmware/core/task/servo_loop.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "tools/bench/tick/model_arm.hpp"

namespace fovea::bench {
namespace {

constexpr std::int64_t kPeriodNs = hal::kTickPeriodNs;

std::int64_t NowNs() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * hal::kNsPerSecond + now.tv_nsec;
}

std::int32_t Clipped(std::int64_t ns) noexcept {
  return static_cast<std::int32_t>(std::min<std::int64_t>(ns, std::numeric_limits<std::int32_t>::max()));
}

// The kernel's counters for this thread since construction.
class Usage {
 public:
  Usage() { getrusage(RUSAGE_THREAD, &begin_); }
  void Fill(Block& block) const {
    rusage end{};
    getrusage(RUSAGE_THREAD, &end);
    block.page_faults = end.ru_minflt + end.ru_majflt - begin_.ru_minflt - begin_.ru_majflt;
    block.voluntary_switches = end.ru_nvcsw - begin_.ru_nvcsw;
    block.involuntary_switches = end.ru_nivcsw - begin_.ru_nivcsw;
  }

 private:
  rusage begin_{};
};

// The real clock. It records how late each wake-up was.
class NotingClock final : public hal::Clock {
 public:
  explicit NotingClock(std::vector<Period>& periods) : periods_(periods) {}
  [[nodiscard]] std::int64_t woken_ns() const noexcept { return woken_ns_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  // The current period; nullptr before the first deadline and when there is no room for it.
  [[nodiscard]] Period* current() noexcept {
    return count_ > 0 && count_ <= periods_.size() ? &periods_[count_ - 1] : nullptr;
  }

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return clock_.NowNs(); }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    const hal::Status status = clock_.WaitUntil(deadline_ns);
    const std::int64_t before_ns = woken_ns_;
    woken_ns_ = clock_.NowNs();
    ++count_;
    if (Period* const period = current(); period != nullptr) {
      period->deadline_ns = deadline_ns;
      period->wake_ns = Clipped(woken_ns_ - deadline_ns);
      period->off_period_ns = before_ns > 0 ? Clipped(std::abs(woken_ns_ - before_ns - kPeriodNs)) : 0;
    }
    return status;
  }

  linux_rt::MonotonicClock clock_;
  std::vector<Period>& periods_;
  std::size_t count_ = 0;
  std::int64_t woken_ns_ = 0;
};

class NotingStages final : public task::StageProbe {
 public:
  explicit NotingStages(NotingClock& clock) : clock_(clock) {}
  void MarkStageEnd(task::Stage stage) noexcept override {
    const std::int64_t now_ns = NowNs();
    const std::int64_t begin_ns = stage == task::Stage::kCheck ? clock_.woken_ns() : last_ns_;
    if (Period* const period = clock_.current(); period != nullptr) {
      period->stage_ns[static_cast<std::size_t>(stage)] = Clipped(now_ns - begin_ns);
    }
    last_ns_ = now_ns;
  }

 private:
  NotingClock& clock_;
  std::int64_t last_ns_ = 0;
};

// The arm behind the seam. It takes the time first, then applies the command.
class BenchArm final : public hal::Arm {
 public:
  BenchArm(const config::ServoConfig& config, NotingClock& clock)
      : Arm(config.arm.num_joints, /*paces_loop=*/false),
        arm_(config.arm, model::ToVector(config.arm.q_ready, config.arm.num_joints)),
        clock_(clock),
        start_ns_(clock.NowNs()) {}
  [[nodiscard]] std::int64_t written_ns() const noexcept { return written_ns_; }

 private:
  // The stamp is a multiple of the period after the start, so it stays right when ticks are missed.
  hal::Status DoRead(hal::ArmState& state) noexcept override {
    state = arm_.State();
    const std::int64_t woken_ns = clock_.count() > 0 ? clock_.woken_ns() : start_ns_;
    state.stamp_ns = start_ns_ + (woken_ns - start_ns_) / kPeriodNs * kPeriodNs;
    return hal::Status::Ok();
  }
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override {
    written_ns_ = NowNs();
    if (Period* const period = clock_.current(); period != nullptr) {
      period->execute_ns = Clipped(written_ns_ - clock_.woken_ns());
      period->response_ns = Clipped(written_ns_ - period->deadline_ns);
    }
    arm_.Tick(command);
    return hal::Status::Ok();
  }

  ModelArm arm_;
  NotingClock& clock_;
  std::int64_t start_ns_;
  std::int64_t written_ns_ = 0;
};

// Records which tick took which picture.
class NotingRecorder final : public hal::Recorder {
 public:
  NotingRecorder(EyeChain& eye, const NotingClock& clock, const BenchArm& arm)
      : eye_(eye), clock_(clock), arm_(arm) {}
  [[nodiscard]] std::uint64_t fault_ticks() const noexcept { return fault_ticks_; }
  void Record(const hal::TickRecord& record) noexcept override {
    fault_ticks_ += record.mode == hal::Mode::kFault ? 1U : 0U;
    if (record.has_feature && clock_.count() > 0) {
      eye_.NoteUse(record.feature.sequence, clock_.woken_ns(), arm_.written_ns());
    }
  }

 private:
  EyeChain& eye_;
  const NotingClock& clock_;
  const BenchArm& arm_;
  std::uint64_t fault_ticks_ = 0;
};

class NoProbe final : public hal::TickProbe {
  void Enter() noexcept override {}
  void Leave() noexcept override {}
};

}  // namespace

Block RunServoBlock(const config::ServoConfig& config, EyeChain& eye, int periods) {
  Block block;
  block.periods.resize(static_cast<std::size_t>(periods));
  task::ServoTask task;
  if (!task.Init(config).ok()) {
    throw std::logic_error("the default configuration is refused");
  }
  NotingClock clock(block.periods);
  NotingStages stages(clock);
  task.UseProbe(&stages);
  BenchArm arm(config, clock);
  NotingRecorder recorder(eye, clock, arm);
  NoProbe probe;
  task::ServoLoop loop(task, arm, clock, eye.mailbox(), recorder, probe);
  hal::FeatureMeasurement old;
  static_cast<void>(eye.mailbox().Take(old));  // drops what arrived since the last block
  const Usage usage;
  const hal::Status status = loop.Run(clock.NowNs() + periods * kPeriodNs);
  usage.Fill(block);
  if (!status.ok()) {
    throw std::runtime_error("the servo loop stopped with an error");
  }
  block.overruns = loop.counters().overruns;
  block.fault_ticks = recorder.fault_ticks();
  // The last wake-up only ends the loop. Missed periods have no wake-up and no entry.
  block.periods.resize(std::min(clock.count() > 0 ? clock.count() - 1 : 0, block.periods.size()));
  return block;
}

Block RunSleepBlock(int periods) {
  Block block;
  block.periods.resize(static_cast<std::size_t>(periods));
  std::size_t count = 0;
  const Usage usage;
  std::int64_t woken_ns = 0;
  std::int64_t deadline_ns = NowNs();
  const std::int64_t end_ns = deadline_ns + periods * kPeriodNs;
  while ((deadline_ns += kPeriodNs) < end_ns && count < block.periods.size()) {
    const timespec deadline{deadline_ns / hal::kNsPerSecond, deadline_ns % hal::kNsPerSecond};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
    const std::int64_t before_ns = woken_ns;
    woken_ns = NowNs();
    const std::int64_t late_ns = woken_ns - deadline_ns;
    Period& period = block.periods[count++];
    period.deadline_ns = deadline_ns;
    period.wake_ns = period.response_ns = Clipped(late_ns);
    period.off_period_ns = before_ns > 0 ? Clipped(std::abs(woken_ns - before_ns - kPeriodNs)) : 0;
    if (late_ns >= kPeriodNs) {
      ++block.overruns;
      deadline_ns += late_ns / kPeriodNs * kPeriodNs;
    }
  }
  usage.Fill(block);
  block.periods.resize(count);
  return block;
}

}  // namespace fovea::bench
