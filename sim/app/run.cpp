#include "sim/app/run.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <thread>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/recording/log/record_hash.hpp"
#include "firmware/host/recording/trace/tick_trace.hpp"
#include "firmware/host/recording/trace/vision_trace.hpp"
#include "firmware/vision/detect/vision_task.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/faulty_detector.hpp"
#include "sim/faults/frame_faults.hpp"
#include "sim/faults/stalling_clock.hpp"
#include "sim/mcu/board_servo.hpp"
#include "sim/mcu/qemu.hpp"
#include "sim/run/eye.hpp"
#include "sim/run/files.hpp"
#include "sim/run/outcome.hpp"
#include "sim/run/progress.hpp"
#include "sim/run/trace.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/verdict/config.hpp"
#include "sim/verdict/mode_watch.hpp"
#include "sim/verdict/target_log.hpp"
#include "sim/world/feature_delay.hpp"
#include "sim/world/sim_arm.hpp"
#include "sim/world/world.hpp"
#include "sim/world/world_clock.hpp"

namespace fovea::sim {
namespace {

constexpr std::size_t kRingCapacity = 4096;  // records; four seconds at 1 kHz

// Everything of one run, wired up. Members stand in the order in which one needs the other.
class Run {
 public:
  Run(const Scenario& scenario, const RunOptions& options)
      : options_(options),
        progress_(scenario.name, scenario.run.duration_s, !options.show_progress),
        about_(Prepare(scenario, progress_)),
        vision_(config::MakeVisionConfig(scenario.vision, about_.intrinsics, scenario.target)),
        stall_(MakeStallFault(scenario.faults, SeedOf(scenario, RandomStream::kStalls))),
        detector_(delay_,
                  MakeDetectorFaults(scenario.faults, SeedOf(scenario, RandomStream::kDetectorFaults))) {
    if (!servo_.Init(about_.servo).ok()) {
      throw std::logic_error("a servo configuration that was checked is refused");
    }
    if (!options_.servo_image.empty()) {
      board_ = std::make_unique<BoardServo>(
          std::make_unique<Qemu>(QemuConfig{options_.servo_image, options_.board.instruction_ns}),
          options_.board, SeedOf(scenario, RandomStream::kBoardLine), about_.servo,
          config::MakeLoad(about_.scenario.arm.load));
    }
    if (!options_.trace.empty()) {
      trace_.emplace(options_.trace, scenario.run.duration_s, scenario.camera.rate_hz, kRenderers);
    }
    if (HasEye()) {
      // Where the world waits for each frame none is ever lost. A real camera keeps two.
      eye_ = std::make_unique<Eye>(about_, WaitsForFrames() ? 1024 : 2, trace_ ? &*trace_ : nullptr);
    }
    // After all that can be refused: what is refused leaves no folder.
    // A board that ticks by its own timer sees other inputs than the host does.
    const bool replayable = !board_ || !options_.board.by_timer;
    files_ = std::make_unique<RunFiles>(about_, RunFilesConfig{options_.out, options_.report, kRenderers,
                                                               options_.pace == Pace::kReal, replayable});
    recorder_ = std::make_unique<flight::FlightRecorder>(
        board_ ? static_cast<task::ServoStep&>(*board_) : servo_,
        !board_ && files_->HasLog() ? &servo_ : nullptr, kRingCapacity);
    BuildWorld();
    if (options_.interrupt != nullptr) {
      options_.interrupt->SetLastAct([this] { files_->KeepLog(); });
    }
  }
  ~Run() {
    if (options_.interrupt != nullptr) {
      options_.interrupt->SetLastAct({});
    }
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  Summary Execute() {
    std::thread vision_thread;
    if (HasEye()) {
      vision_thread = std::thread([this] { RunVisionThread(); });
    }
    if (about_.motion) {
      motion_.emplace(*about_.motion);
    }
    const auto begin = std::chrono::steady_clock::now();
    hal::Status status;
    try {
      status = options_.pace == Pace::kReal ? RunAtRealPace() : RunInLockstep();
    } catch (...) {
      failure_ = std::current_exception();
    }
    wall_time_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (HasEye()) {
      eye_->camera().Close();
      vision_thread.join();
    }
    TakeRecords();
    if (trace_) {
      trace_->Write();
    }
    for (const std::exception_ptr& failure : {failure_, vision_failure_}) {
      if (failure) {
        std::rethrow_exception(failure);
      }
    }
    if (HasEye() && !eye_->camera().fault().empty()) {
      throw std::runtime_error("the camera broke during the run: " + eye_->camera().fault());
    }
    if (!status.ok()) {
      throw std::runtime_error(
          fmt::format("the run broke off: {} ({})", hal::ToString(status.code()), status.where()));
    }
    Summary summary = Summarise();
    progress_.Update(about_.scenario.run.duration_s,
                     interrupted_ ? "interrupted; once more ends at once" : "drawing the pictures");
    files_->Write(summary, world_->Look(), meter_.durations());
    return summary;
  }

 private:
  static RunDescription Prepare(const Scenario& scenario, Progress& progress) {
    progress.Update(0.0, "preparing");
    return DescribeRun(scenario);
  }

  void BuildWorld() {
    verdict_ = std::make_unique<Verdict>(MakeVerdictConfig(about_));
    if (about_.theory) {
      theory_.emplace(*about_.theory);
    }

    const FaultSettings& faults = about_.scenario.faults;
    frame_faults_ = std::make_unique<FrameSpoiler>(
        MakeFrameFaults(faults, SeedOf(about_.scenario, RandomStream::kFrameFaults)));
    world_ = std::make_unique<World>(MakeWorldConfig(about_.scenario, about_.scene.robot));
    world_->OnStep([this](const Truth& truth) { ObserveTruth(truth); });
    const auto latency_ns = static_cast<std::int64_t>(about_.scenario.camera.latency_ms * 1e6);
    world_->OnExposure([this, latency_ns](const Exposure& exposure) {
      if (!HasEye()) {
        files_->AddExposure(exposure);
        return;
      }
      std::optional<Exposure> taken = frame_faults_->Spoil(exposure);
      if (!taken) {
        return;
      }
      targets_.Put(exposure.sequence, {exposure.X_BC.linear().transpose() * exposure.R_BO,
                                       exposure.X_BC.inverse() * exposure.p_BO});
      delay_.Expect(exposure.sequence,
                    exposure.stamp_ns + latency_ns + frame_faults_->DelayNs(exposure.stamp_ns));
      files_->AddExposure(exposure);
      eye_->camera().Expose(*std::move(taken));
    });
    arm_ = std::make_unique<SimArm>(*world_);
    faulty_arm_ = std::make_unique<FaultyArm>(
        *arm_, MakeArmFaults(faults, SeedOf(about_.scenario, RandomStream::kArmFaults)));
  }

  void ObserveTruth(const Truth& truth) {
    verdict_->AddTruth(truth, modes_.mode());
    files_->AddTruth(truth);
    if (theory_) {
      files_->AddTheory(theory_->Add(truth));
    }
    if (options_.observer.on_truth) {
      options_.observer.on_truth(truth);
    }
  }

  void RunVisionThread() {
    linux_rt::MakeThreadYielding("fovea-vision");
    std::optional<trace::VisionTrace> traced;
    if (trace_) {
      traced.emplace(trace_->vision(), eye_->camera(), detector_);
    }
    try {
      const hal::Status status =
          vision::RunVision(traced ? static_cast<hal::Camera&>(*traced) : eye_->camera(), vision_,
                            traced ? static_cast<hal::FeatureSink&>(*traced) : detector_, never_stop_,
                            [this](const hal::Frame& frame, const vision::Detection& detection) {
                              files_->AddFrame(frame, detection, targets_.Take(frame.sequence));
                            });
      static_cast<void>(status);  // an orderly end, or a fault that the camera keeps the words for
    } catch (...) {
      vision_failure_ = std::current_exception();
    }
    delay_.Close();
  }

  [[nodiscard]] std::int64_t EndNs() const {
    return static_cast<std::int64_t>(about_.scenario.run.duration_s * static_cast<double>(hal::kNsPerSecond));
  }

  void TakeRecords() {
    const auto take = [this](const flight::FlightRecord& flown) {
      const hal::TickRecord& record = flown.record;
      hash_.Add(record);
      verdict_->AddRecord(record);
      files_->AddRecord(flown);
      if (options_.observer.on_record) {
        options_.observer.on_record(record);
      }
      mode_ = record.mode;
      recorded_s_ = static_cast<double>(record.stamp_ns) * 1e-9;
    };
    recorder_->Drain(take, [this](const flight::Keyframe& keyframe) { files_->AddKeyframe(keyframe); });
  }

  // Runs the servo by `clock` to the run's end, watched by a timeline where one is asked for.
  hal::Status RunLoop(hal::Clock& clock) {
    std::optional<BoardClock> board_clock;
    if (board_) {
      board_clock.emplace(clock, *board_);
    }
    StallingClock stalling(board_clock ? static_cast<hal::Clock&>(*board_clock) : clock, stall_);
    std::optional<trace::TickTrace> ticks;
    std::optional<trace::ClockTrace> world;
    if (trace_) {
      servo_.UseProbe(&ticks.emplace(trace_->servo(), meter_, *recorder_));
      world.emplace(trace_->servo(), stalling, "world");
    }
    modes_.PassTo(ticks ? static_cast<hal::Recorder&>(*ticks) : *recorder_);
    task::ServoLoop loop(*recorder_, *faulty_arm_, world ? static_cast<hal::Clock&>(*world) : stalling,
                         mailbox_, modes_, ticks ? static_cast<hal::TickProbe&>(*ticks) : meter_);
    if (motion_) {
      loop.UseMotion(*motion_);
    }
    loop_ = &loop;
    const hal::Status status = loop.Run(EndNs());
    loop_ = nullptr;
    counters_ = loop.counters();
    servo_.UseProbe(nullptr);
    return status;
  }

  [[nodiscard]] bool IsInterrupted() const {
    return options_.interrupt != nullptr && options_.interrupt->Came();
  }

  // Between two ticks, on the servo's thread: what is due of the measurements goes to the servo.
  bool HandOver(std::int64_t now_ns, bool wait) {
    if (IsInterrupted() && now_ns < EndNs()) {
      interrupted_ = true;
      loop_->Stop();  // after the tick in hand, which has its records
      return true;
    }
    if (!trace_) {
      return delay_.HandOver(now_ns, wait, mailbox_);
    }
    const std::int64_t begin_ns = trace::NowNs();
    trace::SinkTrace traced(trace_->servo(), mailbox_);
    const bool open = delay_.HandOver(now_ns, wait, traced);
    trace_->servo().Add({"wait for vision", begin_ns, trace::NowNs(), -1, trace::Flow::kNone});
    return open;
  }

  hal::Status RunInLockstep() {
    LockstepClock clock(*world_, [&](std::int64_t now_ns) {
      const std::int64_t begin_ns = trace_ ? trace::NowNs() : 0;
      TakeRecords();
      progress_.Update(recorded_s_, hal::Name(mode_));
      if (trace_) {
        trace_->servo().Add({"records", begin_ns, trace::NowNs(), -1, trace::Flow::kNone});
      }
      if (board_ && !board_->failure().empty()) {
        throw std::runtime_error(board_->failure() + "; the arm's brakes were closed");
      }
      return HandOver(now_ns, /*wait=*/true);
    });
    const hal::Status status = RunLoop(clock);
    clock.RethrowFailure();
    return status;
  }

  hal::Status RunAtRealPace() {
    linux_rt::MonotonicClock monotonic;
    hal::Clock& given = options_.clock != nullptr ? *options_.clock : monotonic;
    std::optional<trace::ClockTrace> sleep;
    if (trace_) {
      sleep.emplace(trace_->servo(), given, "sleep");
    }
    std::atomic<bool> done{false};
    hal::Status status;
    std::optional<RealPaceClock> clock;  // its time begins when the thread is ready
    std::jthread servo_thread([&] {      // joins, whatever is thrown below
      realtime_missing_ = linux_rt::MakeThreadRealtime({});
      clock.emplace(*world_, sleep ? static_cast<hal::Clock&>(*sleep) : given,
                    [&](std::int64_t now_ns) { return HandOver(now_ns, WaitsForFrames()); });
      status = RunLoop(*clock);
      done = true;
    });
    while (!done) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      TakeRecords();
      progress_.Update(recorded_s_, hal::Name(mode_));
    }
    servo_thread.join();
    clock->RethrowFailure();
    return status;
  }

  Summary Summarise() {
    Summary s;
    s.scenario = about_.scenario.name;
    s.seed = about_.scenario.run.seed;
    s.pace = options_.pace == Pace::kReal ? "real" : "lockstep";
    s.sim_time_s = static_cast<double>(world_->now_ns()) * 1e-9;
    s.frames = files_->frames();
    s.frames_detected = files_->frames_detected();
    run::FillBook(files_->EndFilms(), s);
    verdict_->Fill(s);
    if (theory_) {
      FillTheory(theory_->Finish(), s);
    }
    FillFrameFailures(vision_.failures(), s);
    if (interrupted_) {
      FillInterrupted(s.sim_time_s, about_.scenario.run.duration_s, s);
    }
    run::FillTicks(counters_, meter_, s);
    s.frames_lost = HasEye() ? eye_->camera().lost() : 0;
    s.records_dropped = recorder_->dropped();
    if (board_) {
      s.mcu = board_->Summarise();
    }
    s.wall_time_s = wall_time_s_;
    s.real_time_factor = s.sim_time_s / s.wall_time_s;
    s.realtime_missing = realtime_missing_;
    s.renderer = HasEye() ? eye_->driver_name() : "nothing";
    s.log_hash = hash_.Finish();
    return s;
  }

  [[nodiscard]] bool HasEye() const { return about_.scenario.camera.enabled; }
  [[nodiscard]] bool WaitsForFrames() const {
    return options_.pace == Pace::kLockstep || options_.clock != nullptr;
  }

  RunOptions options_;
  Progress progress_;
  const RunDescription about_;
  vision::VisionTask vision_;
  task::ServoTask servo_;
  std::unique_ptr<BoardServo> board_;  // instead of `servo_`
  const StallFault stall_;
  std::optional<RunTrace> trace_;
  std::unique_ptr<RunFiles> files_;
  std::unique_ptr<Eye> eye_;
  std::unique_ptr<Verdict> verdict_;
  std::optional<TheoryRun> theory_;
  std::optional<CommandedMotionSource> motion_;
  ModeWatch modes_;  // for the verdict, which may not wait for the records
  std::unique_ptr<World> world_;
  std::unique_ptr<SimArm> arm_;
  std::unique_ptr<FaultyArm> faulty_arm_;
  std::unique_ptr<FrameSpoiler> frame_faults_;
  FeatureDelay delay_;
  FaultyDetector detector_;
  hal::FeatureMailbox mailbox_;
  std::unique_ptr<flight::FlightRecorder> recorder_;
  linux_rt::TickMeter meter_;
  log::RecordHash hash_;
  TargetLog targets_;
  const std::atomic<bool> never_stop_{false};  // the vision thread ends when the camera closes
  task::ServoLoop* loop_ = nullptr;            // while it runs, for its own thread
  bool interrupted_ = false;                   // before its end
  task::LoopCounters counters_;
  hal::Mode mode_ = hal::Mode::kBoot;  // of the last record
  double recorded_s_ = 0.0;            // and its time
  std::vector<std::string> realtime_missing_;
  double wall_time_s_ = 0.0;
  std::exception_ptr failure_;  // what the run threw, and what the vision thread threw
  std::exception_ptr vision_failure_;
};

}  // namespace

Summary RunScenario(const Scenario& scenario, const RunOptions& options) {
  return Run(scenario, options).Execute();
}

}  // namespace fovea::sim
