#include "timed_loop.hpp"

#include <sys/resource.h>
#include <time.h>

#include <array>
#include <limits>
#include <stdexcept>

#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/servo/servo_loop.hpp"
#include "model_arm.hpp"

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

// What the kernel counted for this thread meanwhile.
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

// The real clock, which notes how late each wake-up was.
class NotingClock final : public hal::Clock {
 public:
  explicit NotingClock(std::vector<Period>& periods) : periods_(periods) {}
  [[nodiscard]] std::int64_t deadline_ns() const noexcept { return deadline_ns_; }
  [[nodiscard]] std::int64_t woken_ns() const noexcept { return woken_ns_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return clock_.NowNs(); }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    const hal::Status status = clock_.WaitUntil(deadline_ns);
    deadline_ns_ = deadline_ns;
    woken_ns_ = clock_.NowNs();
    if (count_ < periods_.size()) {
      periods_[count_].wake_ns = Clipped(woken_ns_ - deadline_ns);
    }
    ++count_;
    return status;
  }

  linux_rt::MonotonicClock clock_;
  std::vector<Period>& periods_;
  std::size_t count_ = 0;
  std::int64_t deadline_ns_ = 0;
  std::int64_t woken_ns_ = 0;
};

// The arm behind the seam. What it does with a command comes after the time was taken.
class BenchArm final : public hal::Arm {
 public:
  BenchArm(const servo::ServoConfig& config, const ModelArm& arm, const model::Vec3& p_BO, NotingClock& clock,
           hal::FeatureMailbox& features, std::vector<Period>& periods)
      : Arm(config.arm.num_joints, /*paces_loop=*/false),
        config_(config),
        arm_(arm),
        p_BO_(p_BO),
        clock_(clock),
        features_(features),
        periods_(periods) {}

 private:
  hal::Status DoRead(hal::ArmState& state) noexcept override {
    state = arm_.State();
    return hal::Status::Ok();
  }
  hal::Status DoWrite(const hal::ArmCommand& command) noexcept override {
    const std::int64_t done_ns = NowNs();
    if (const std::size_t count = clock_.count(); count > 0 && count <= periods_.size()) {
      Period& period = periods_[count - 1];
      period.execute_ns = Clipped(done_ns - clock_.woken_ns());
      period.response_ns = Clipped(done_ns - clock_.deadline_ns());
    }
    arm_.Tick(command);
    const std::size_t slot = ticks_ % seen_.size();
    if (ticks_ >= seen_.size() && ticks_ % kFrameTicks == 0) {
      features_.Put(seen_[slot]);
    }
    seen_[slot] = Measure(config_, arm_, p_BO_);
    ++ticks_;
    return hal::Status::Ok();
  }

  const servo::ServoConfig& config_;
  ModelArm arm_;
  model::Vec3 p_BO_;
  NotingClock& clock_;
  hal::FeatureMailbox& features_;
  std::vector<Period>& periods_;
  std::array<hal::FeatureMeasurement, kLatencyTicks> seen_;
  std::size_t ticks_ = 0;
};

class NoRecorder final : public hal::Recorder {
  void Record(const hal::TickRecord& /*record*/) noexcept override {}
};
class NoProbe final : public hal::TickProbe {
  void Enter() noexcept override {}
  void Leave() noexcept override {}
};

}  // namespace

Block RunServoBlock(const model::ArmModel& arm, int periods) {
  Block block;
  block.periods.resize(static_cast<std::size_t>(periods));
  const servo::ServoConfig config = DefaultConfig(arm);
  servo::ServoTask task;
  if (!task.Init(config).ok()) {
    throw std::logic_error("the default configuration is refused");
  }
  model::VecN q = model::ToVector(arm.q_ready, arm.num_joints);
  q[0] -= 0.3;
  NotingClock clock(block.periods);
  hal::FeatureMailbox features;
  BenchArm bench_arm(config, ModelArm(arm, q), CameraAt(config, q) * model::Vec3(-0.10, 0.08, 0.55), clock,
                     features, block.periods);
  NoRecorder recorder;
  NoProbe probe;
  servo::ServoLoop loop(task, bench_arm, clock, features, recorder, probe);
  const Usage usage;
  const hal::Status status = loop.Run(clock.NowNs() + periods * kPeriodNs);
  usage.Fill(block);
  if (!status.ok()) {
    throw std::runtime_error("the servo's loop broke off");
  }
  block.overruns = loop.counters().overruns;
  // The last wake-up ends the loop; a late one takes the place of those that it missed.
  block.periods.resize(std::min(clock.count() > 0 ? clock.count() - 1 : 0, block.periods.size()));
  return block;
}

Block RunSleepBlock(int periods) {
  Block block;
  block.periods.resize(static_cast<std::size_t>(periods));
  std::size_t count = 0;
  const Usage usage;
  std::int64_t deadline_ns = NowNs();
  const std::int64_t end_ns = deadline_ns + periods * kPeriodNs;
  while ((deadline_ns += kPeriodNs) < end_ns && count < block.periods.size()) {
    const timespec deadline{deadline_ns / hal::kNsPerSecond, deadline_ns % hal::kNsPerSecond};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr);
    const std::int64_t late_ns = NowNs() - deadline_ns;
    Period& period = block.periods[count++];
    period.wake_ns = period.response_ns = Clipped(late_ns);
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
