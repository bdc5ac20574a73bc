// SPDX-License-Identifier: Apache-2.0
#include "tests/soak/soak.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <deque>
#include <fstream>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <thread>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/vision/detect/vision_task.hpp"
#include "fovea/linux_rt/heap_counter.hpp"
#include "sim/camera/mix_bits.hpp"
#include "sim/run/eye.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/scenario/world_config.hpp"
#include "sim/world/feature_delay.hpp"
#include "sim/world/sim_arm.hpp"
#include "sim/world/world_clock.hpp"
#include "tests/soak/director.hpp"
#include "tests/soak/seam.hpp"
#include "tests/support/truth_eye.hpp"

namespace fovea::soak {
namespace {

constexpr int kMemorySamples = 200;
constexpr double kResidentMost = 4.0 * 1048576.0;  // allowed growth [bytes]
constexpr double kHeapMost = 0.25 * 1048576.0;
constexpr double kSigmaPx = 0.05;  // noise of features made from the truth
constexpr double kNothing = 0.02;  // relative change of a figure that does not count as drift
constexpr std::int64_t kLateNs = 60 * hal::kNsPerMs;
constexpr std::int64_t kHourNs = 3600 * hal::kNsPerSecond;

Start StartOf(const SoakOptions& options, std::uint64_t ticks) {
  if (!options.late_clock) {
    return {};
  }
  // The counters pass 2^32 in the middle of the run.
  const std::uint64_t before = (std::uint64_t{1} << 32U) - ticks / 2;
  return {std::numeric_limits<std::int64_t>::max() - 30 * kHourNs, before, before};
}

double ResidentBytes() {
  std::ifstream stream("/proc/self/statm");
  double all = 0.0;
  double resident = 0.0;
  stream >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double HeapInUse() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

// Counts heap calls in the tick.
class HeapProbe final : public hal::TickProbe {
 public:
  void Enter() noexcept override { linux_rt::EnterCountedRegion(); }
  void Leave() noexcept override { linux_rt::LeaveCountedRegion(); }
};

class Digest final : public hal::Recorder {
 public:
  explicit Digest(std::uint64_t first_tick) : next_tick_(first_tick) {}

  void Record(const hal::TickRecord& record) noexcept override {
    Add(static_cast<std::uint64_t>(record.mode) | static_cast<std::uint64_t>(record.hold_reason) << 8U |
        static_cast<std::uint64_t>(record.fault) << 16U |
        static_cast<std::uint64_t>(record.limits_active) << 24U);
    Add(static_cast<std::uint64_t>(record.feature_age_ns));
    for (std::size_t i = 0; i < static_cast<std::size_t>(record.command.num_joints); ++i) {
      Add(std::bit_cast<std::uint64_t>(record.command.tau_cmd[i]));
      Add(std::bit_cast<std::uint64_t>(record.q_cmd[i]));
    }
    out_of_order_ += record.tick != next_tick_ ? 1U : 0U;
    back_ += has_last_ && record.stamp_ns <= last.stamp_ns ? 1U : 0U;
    next_tick_ = record.tick + 1;
    has_last_ = true;
    last = record;
  }

  [[nodiscard]] std::uint64_t value() const { return value_; }
  [[nodiscard]] std::uint64_t out_of_order() const { return out_of_order_; }
  [[nodiscard]] std::uint64_t back() const { return back_; }
  hal::TickRecord last;

 private:
  void Add(std::uint64_t bits) { value_ = sim::MixBits(value_ + 0x9E3779B97F4A7C15U) ^ bits; }

  std::uint64_t value_ = 0;
  std::uint64_t next_tick_;
  std::uint64_t out_of_order_ = 0;
  std::uint64_t back_ = 0;
  bool has_last_ = false;
};

// One pass. The order of the members follows their dependencies.
class Pass {
 public:
  Pass(const SoakOptions& options, const sim::RunDescription& about, std::function<void(double)> progress)
      : options_(options),
        about_(about),
        progress_(std::move(progress)),
        end_ns_(static_cast<std::int64_t>(options.hours * static_cast<double>(kHourNs)) / hal::kTickPeriodNs *
                hal::kTickPeriodNs),
        start_(StartOf(options, static_cast<std::uint64_t>(end_ns_ / hal::kTickPeriodNs))),
        director_(about, end_ns_, options.seed),
        truth_eye_(about.servo.feature, about.pinhole.f_px, kSigmaPx, static_cast<unsigned>(options.seed)),
        vision_(config::MakeVisionConfig(about.scenario.vision, about.intrinsics, about.scenario.target)),
        world_(sim::MakeWorldConfig(about)),
        digest_(start_.tick),
        features_(mailbox_, start_, director_.acting()),
        sim_arm_(world_),
        arm_(sim_arm_, start_, director_.acting()),
        lockstep_(world_, [this](std::int64_t now_ns) { return Between(now_ns); }),
        clock_(lockstep_, start_, director_.acting()),
        loop_(task_, arm_, clock_, mailbox_, digest_, probe_) {
    if (!task_.Init(about.servo).ok()) {
      throw std::logic_error("the servo refuses a checked configuration");
    }
    task::ServoState state = task_.state();
    state.tick = start_.tick;
    task_.Restore(state);
    loop_.UseMotion(director_);
    if (options.camera) {
      eye_ = std::make_unique<sim::Eye>(about, sim::EyeOptions{.queue = 1024});
    }
    memory_.reserve(kMemorySamples + 2);
    heap_.reserve(kMemorySamples + 2);
    world_.OnExposure([this](sim::Exposure exposure) { Expose(std::move(exposure)); });
  }

  SoakResult Run() {
    std::thread vision_thread;
    if (eye_) {
      vision_thread = std::thread([this] {
        static_cast<void>(vision::RunVision(eye_->camera(), vision_, delay_, never_stop_, {}));
        delay_.Close();
      });
    }
    const std::uint64_t heap_before = linux_rt::CountedHeapCalls();
    const auto begin = std::chrono::steady_clock::now();
    const hal::Status status = loop_.Run(end_ns_ + start_.clock_ns);
    SoakResult result;
    result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    result.heap_calls = linux_rt::CountedHeapCalls() - heap_before;
    if (eye_) {
      eye_->camera().Close();
      vision_thread.join();
    }
    lockstep_.RethrowFailure();
    if (!status.ok()) {
      result.failures.push_back(fmt::format("the loop ended early: {}", hal::ToString(status.code())));
    }
    Summarise(result);
    return result;
  }

 private:
  // Called between two ticks, after the world has advanced.
  bool Between(std::int64_t now_ns) {
    if (now_ns >= next_sample_ns_) {
      const double robot_s = static_cast<double>(now_ns) * 1e-9;
      memory_.push_back({robot_s, ResidentBytes()});
      heap_.push_back({robot_s, HeapInUse()});
      next_sample_ns_ = now_ns + std::max<std::int64_t>(end_ns_ / kMemorySamples, hal::kNsPerMs);
      progress_(static_cast<double>(now_ns) / static_cast<double>(end_ns_));
    }
    for (; stepped_ns_ < now_ns; stepped_ns_ += hal::kTickPeriodNs) {
      director_.Step(stepped_ns_ + hal::kTickPeriodNs, world_.truth(), digest_.last, task_.state());
      if (const task::Request request = director_.TakeRequest(); request != task::Request::kNone) {
        loop_.Ask(request);
      }
    }
    world_.PullAt(director_.pull());
    if (eye_) {
      return delay_.HandOver(now_ns, /*wait=*/true, features_);
    }
    while (!under_way_.empty() && under_way_.front().first <= now_ns) {
      features_.Put(under_way_.front().second);
      under_way_.pop_front();
    }
    return true;
  }

  void Expose(sim::Exposure exposure) {
    exposure.p_BO = director_.TargetAt(exposure.stamp_ns);
    exposure.R_BO = director_.R_BO();
    const auto latency_ns = static_cast<std::int64_t>(about_.scenario.camera.latency_ms * 1e6);
    const bool late = director_.acting().trouble == Trouble::kLateFeature;
    const std::int64_t due_ns = exposure.stamp_ns + latency_ns + (late ? kLateNs : 0);
    if (eye_) {
      delay_.Expect(exposure.sequence, due_ns);
      eye_->camera().Expose(std::move(exposure));
      return;
    }
    const Eigen::Isometry3d X_CB = exposure.X_BC.inverse();
    const model::Pose X_CO{X_CB.linear() * exposure.R_BO, X_CB * exposure.p_BO};
    hal::FeatureMeasurement m = truth_eye_.See(X_CO, exposure.stamp_ns, exposure.sequence);
    if (!IsInPicture(X_CO)) {
      m.found = false;
      m.dim = 0;
    }
    under_way_.emplace_back(due_ns, m);
  }

  [[nodiscard]] bool IsInPicture(const model::Pose& X_CO) const {
    const features::TargetOutline outline = about_.servo.feature.Outline();
    for (int i = 0; i < outline.num_points; ++i) {
      const model::Vec3 p = X_CO * outline.p_OP[static_cast<std::size_t>(i)];
      if (!(p.z() > 0.05)) {
        return false;
      }
      const double reach = about_.pinhole.f_px * outline.radius / p.z();
      const double u = about_.pinhole.U(p);
      const double v = about_.pinhole.V(p);
      if (u < reach || v < reach || u > about_.pinhole.width_px - 1 - reach ||
          v > about_.pinhole.height_px - 1 - reach) {
        return false;
      }
    }
    return true;
  }

  void Summarise(SoakResult& result) const {
    result.robot_s = static_cast<double>(end_ns_) * 1e-9;
    const task::LoopCounters& counters = loop_.counters();
    result.ticks = counters.ticks;
    result.missed_ticks = counters.missed_ticks;
    for (std::size_t i = 0; i < kEndingNames.size(); ++i) {
      result.endings[kEndingNames[i]] = director_.endings()[i];
    }
    for (std::size_t i = 0; i < kTroubleNames.size(); ++i) {
      result.troubles[kTroubleNames[i]] = director_.troubles()[i];
    }
    result.faults = director_.faults();
    result.recoveries = director_.recoveries();
    result.ways_home = director_.ways_home();
    result.ways_refused = director_.ways_refused();
    result.digest = digest_.value();
    const auto expect = [&result](bool good, const std::string& what) {
      if (!good) {
        result.failures.push_back(what);
      }
    };
    expect(linux_rt::HeapCounterActive(), "heap calls are not counted in this build");
    expect(result.heap_calls == 0, fmt::format("{} heap calls in ticks", result.heap_calls));
    const auto periods = static_cast<std::uint64_t>(end_ns_ / hal::kTickPeriodNs);
    expect(counters.ticks + counters.missed_ticks == periods,
           fmt::format("{} ticks and {} missed do not sum to {}", counters.ticks, counters.missed_ticks,
                       periods));
    expect(
        clock_.swallowed() - counters.missed_ticks <= MostCutOff(),
        fmt::format("{} ticks swallowed, {} counted as missed", clock_.swallowed(), counters.missed_ticks));
    expect(counters.arm_read_errors == arm_.silent_reads(),
           fmt::format("{} silent reads, {} counted", arm_.silent_reads(), counters.arm_read_errors));
    expect(counters.arm_write_errors == 0, fmt::format("{} commands refused", counters.arm_write_errors));
    expect(digest_.out_of_order() == 0, fmt::format("{} ticks out of order", digest_.out_of_order()));
    expect(task_.state().tick == start_.tick + counters.ticks, "the tick counter missed ticks");
    expect(director_.num_complaints() == 0,
           fmt::format("{} unexpected events, first: {}", director_.num_complaints(),
                       director_.complaints().empty() ? "" : director_.complaints().front()));
    for (const std::string& complaint : director_.complaints()) {
      result.failures.push_back("  " + complaint);
    }
    const Growth resident = JudgeMemory(memory_, kResidentMost);
    const Growth heap = JudgeMemory(heap_, kHeapMost);
    result.resident_growth = resident.bytes;
    result.heap_growth = heap.bytes;
    expect(!resident.leaks, fmt::format("resident memory grew by {:.0f} KiB", resident.bytes / 1024.0));
    expect(!heap.leaks, fmt::format("the heap grew by {:.0f} KiB", heap.bytes / 1024.0));
    SummariseDrift(result);
  }

  // The last wait may end after the run.
  [[nodiscard]] std::uint64_t MostCutOff() const {
    return static_cast<std::uint64_t>(2 * about_.servo.safety.missed_ticks);
  }

  void SummariseDrift(SoakResult& result) const {
    const Figures& f = director_.figures();
    const std::pair<const char*, const Tenths*> all[] = {{"error_px", &f.error_px},
                                                         {"joint_speed_rad_s", &f.speed},
                                                         {"torque_nm", &f.torque},
                                                         {"covariance_m2", &f.covariance},
                                                         {"posture_rad", &f.posture}};
    for (const auto& [name, tenths] : all) {
      const Drift drift = JudgeDrift(*tenths, kNothing * tenths->front().mean);
      result.drift.push_back({name, tenths->front().mean, tenths->back().mean, drift.sigmas});
      if (drift.drifts) {
        result.failures.push_back(fmt::format("{} drifts: {:.4g} in the first tenth, {:.4g} in the last",
                                              name, tenths->front().mean, tenths->back().mean));
      }
    }
  }

  const SoakOptions& options_;
  const sim::RunDescription& about_;
  std::function<void(double)> progress_;
  const std::int64_t end_ns_;
  const Start start_;
  Director director_;
  test::TruthEye truth_eye_;
  vision::VisionTask vision_;
  std::unique_ptr<sim::Eye> eye_;
  sim::FeatureDelay delay_;
  const std::atomic<bool> never_stop_{false};
  sim::World world_;
  Digest digest_;
  hal::FeatureMailbox mailbox_;
  SoakFeatures features_;
  std::deque<std::pair<std::int64_t, hal::FeatureMeasurement>> under_way_;  // by due time
  sim::SimArm sim_arm_;
  SoakArm arm_;
  sim::LockstepClock lockstep_;
  SoakClock clock_;
  HeapProbe probe_;
  task::ServoTask task_;
  task::ServoLoop loop_;
  std::int64_t stepped_ns_ = 0;
  std::int64_t next_sample_ns_ = 0;
  std::vector<MemorySample> memory_;
  std::vector<MemorySample> heap_;
};

}  // namespace

SoakResult RunSoak(const SoakOptions& options) {
  const sim::RunDescription about =
      sim::DescribeRun(sim::LoadScenario(options.scenario, options.assignments));
  SoakResult result;
  for (int i = 0; i < options.passes; ++i) {
    const auto progress = [&options, i](double share) {
      if (options.progress) {
        options.progress((i + share) / options.passes);
      }
    };
    SoakResult pass = std::make_unique<Pass>(options, about, progress)->Run();
    if (i == 0) {
      result = std::move(pass);
      continue;
    }
    if (pass.digest != result.digest) {
      result.failures.push_back(fmt::format("pass {} has the digest {:016x}, the first {:016x}", i + 1,
                                            pass.digest, result.digest));
    }
    result.failures.insert(result.failures.end(), pass.failures.begin(), pass.failures.end());
  }
  return result;
}

}  // namespace fovea::soak
