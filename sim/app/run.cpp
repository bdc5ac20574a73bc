// SPDX-License-Identifier: Apache-2.0
#include "sim/app/run.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <optional>
#include <thread>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/host/recording/trace/tick_trace.hpp"
#include "firmware/host/run/run_shell.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "sim/faults/faulty_arm.hpp"
#include "sim/faults/stalling_clock.hpp"
#include "sim/mcu/board_servo.hpp"
#include "sim/mcu/qemu.hpp"
#include "sim/operator/live_session.hpp"
#include "sim/run/files.hpp"
#include "sim/run/outcome.hpp"
#include "sim/run/progress.hpp"
#include "sim/run/run_beliefs.hpp"
#include "sim/run/sim_planner.hpp"
#include "sim/run/sim_vision.hpp"
#include "sim/run/trace.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/run_description.hpp"
#include "sim/scenario/world_config.hpp"
#include "sim/verdict/config.hpp"
#include "sim/verdict/mode_watch.hpp"
#include "sim/world/sim_arm.hpp"
#include "sim/world/world.hpp"
#include "sim/world/world_clock.hpp"

namespace fovea::sim {
namespace {

constexpr std::size_t kRecords = 4096;  // capacity of the record queue: four seconds at 1 kHz

// One run with all its parts. The declaration order of the members matters: later ones use earlier ones.
class Run {
 public:
  Run(const Scenario& scenario, const RunOptions& options)
      : options_(options),
        progress_(scenario.name, scenario.run.duration_s, !options.show_progress),
        about_(Prepare(scenario, progress_)),
        stall_(Seeded(scenario.faults.stall, SeedOf(scenario, RandomStream::kStalls))),
        vision_(about_, [this](const hal::Frame& frame, const vision::Detection& detection,
                               const model::Pose& X_CO) { files_->AddFrame(frame, detection, X_CO); }) {
    if (!servo_.Init(about_.servo).ok()) {
      throw std::logic_error("the servo refuses a configuration that passed the check");
    }
    if (!options_.servo_image.empty()) {
      board_ = std::make_unique<BoardServo>(
          std::make_unique<Qemu>(QemuConfig{options_.servo_image, options_.board.instruction_ns}),
          options_.board, SeedOf(scenario, RandomStream::kBoardLine), about_.servo,
          config::MakeLoad(about_.scenario.arm.load));
    }
    if (!options_.trace.empty()) {
      trace_.emplace(options_.trace, scenario.run.duration_s, scenario.camera.rate_hz, options_.renderers);
    }
    if (HasEye()) {
      // If the world waits for each frame, no frame is lost. A real camera buffers two.
      const bool is_recorded = options_.live != nullptr || (options_.report && !options_.out.empty());
      vision_.Open({WaitsForFrames() ? std::size_t{1024} : 2, trace_ ? &*trace_ : nullptr, options_.renderers,
                    options_.pool, WaitsForFrames() && !is_recorded});
    }
    // The folder is created last, so that a refused run leaves none.
    // A board that ticks by its own timer sees other inputs than the host: its log cannot be replayed.
    const bool replayable = !board_ || !options_.board.by_timer;
    RunFilesConfig files{.out = options_.out,
                         .report = options_.report,
                         .pictures_if_failed = options_.pictures_if_failed,
                         .renderer_index = options_.renderers,
                         .may_drop = options_.pace == Pace::kReal,
                         .replayable = replayable,
                         .command = options_.command};
    if (options_.live != nullptr) {
      files.tap = options_.live->tap();
      files.open_ended = true;
    }
    shell_.emplace(board_ ? static_cast<task::ServoStep&>(*board_) : servo_, board_ ? nullptr : &servo_,
                   kRecords, FolderOf(about_, files));
    shell_->OnRecord([this](const flight::FlightRecord& flown) { ObserveRecord(flown.record); });
    files_ = std::make_unique<RunFiles>(about_, files, *shell_);
    if (options_.live != nullptr) {
      live_.emplace(*options_.live, *shell_, options_.live_speed);
    }
    if (trace_) {
      shell_->UseTrack(trace_->servo());
    }
    BuildWorld();
    if (options_.interrupt != nullptr) {
      options_.interrupt->SetLastAct([this] { shell_->KeepLog(); });
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
    if (HasEye()) {
      vision_.Begin();
    }
    if (about_.motion) {
      motion_.emplace(*about_.motion);
    }
    const Instant begin = std::chrono::steady_clock::now();
    hal::Status status;
    std::exception_ptr failure;
    try {
      status = options_.pace == Pace::kReal ? RunAtRealPace() : RunInLockstep();
    } catch (...) {
      failure = std::current_exception();
    }
    wall_time_s_ = SecondsSince(begin);
    vision_.End();
    shell_->TakeRecords();
    const std::string trace_error = trace_ ? trace_->Write() : "";
    if (failure) {
      std::rethrow_exception(failure);
    }
    vision_.RethrowFailure();
    if (!status.ok()) {
      throw std::runtime_error(
          fmt::format("the run failed: {} ({})", hal::ToString(status.code()), status.where()));
    }
    Summary summary = Summarise();
    summary.preparing_s = std::chrono::duration<double>(begin - made_).count();
    progress_.Update(about_.scenario.run.duration_s,
                     interrupted_ ? "interrupted; Ctrl-C again ends at once" : "drawing the pictures");
    const Instant simulated = std::chrono::steady_clock::now();
    summary.files_error = trace_error;
    try {
      files_->Write(summary, world_->Look());
    } catch (const std::exception& error) {
      summary.files_error += (trace_error.empty() ? "" : "; ") + std::string(error.what());
    }
    summary.writing_s = SecondsSince(simulated);
    return summary;
  }

 private:
  using Instant = std::chrono::steady_clock::time_point;
  static double SecondsSince(Instant begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  static RunDescription Prepare(const Scenario& scenario, Progress& progress) {
    RunDescription about = DescribeRun(scenario);  // before any progress: an error is the only output
    progress.Update(0.0, "preparing");
    return about;
  }

  void BuildWorld() {
    verdict_ = std::make_unique<Verdict>(MakeVerdictConfig(about_));
    shell_->UsePlanner(planner_.emplace(about_.servo, about_.reach, about_.scenario.faults.planner).box());
    beliefs_.emplace(about_, options_.live != nullptr, WaitsForFrames());
    if (about_.theory) {
      theory_.emplace(*about_.theory);
    }

    const FaultSettings& faults = about_.scenario.faults;
    WorldConfig world = MakeWorldConfig(about_);
    world.physics.may_be_loaded = options_.live != nullptr;  // a viewer may hang a load at the hand
    world_ = std::make_unique<World>(world);
    world_->OnStep([this](const Truth& truth) { ObserveTruth(truth); });
    world_->OnExposure([this](const Exposure& exposure) {
      if (!HasEye() || vision_.Expose(exposure)) {
        files_->AddExposure(exposure);
      }
    });
    arm_ = std::make_unique<SimArm>(*world_);
    faulty_arm_ = std::make_unique<FaultyArm>(
        *arm_, Seeded(faults.arm, SeedOf(about_.scenario, RandomStream::kArmFaults)));
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

  [[nodiscard]] std::int64_t EndNs() const {
    if (live_) {
      return INT64_MAX / 2;
    }
    return static_cast<std::int64_t>(about_.scenario.run.duration_s * static_cast<double>(hal::kNsPerSecond));
  }

  void ObserveRecord(const hal::TickRecord& record) {
    verdict_->AddRecord(record);
    beliefs_->Add(record);
    if (options_.observer.on_record) {
      options_.observer.on_record(record);
    }
  }

  // Called by the main thread at real pace; in lockstep by the servo's thread, between two ticks.
  void TakeRecords() {
    shell_->TakeRecords();
    beliefs_->Act();
    progress_.Update(shell_->now_s(), hal::Name(shell_->mode()));
  }

  // Runs the servo by `clock` to the run's end. Records a timeline if one is requested.
  hal::Status RunLoop(hal::Clock& clock) {
    std::optional<BoardClock> board_clock;
    if (board_) {
      board_clock.emplace(clock, *board_);
    }
    StallingClock& stalling =
        stalling_.emplace(board_clock ? static_cast<hal::Clock&>(*board_clock) : clock, stall_);
    stalling.EndAt(EndNs());
    std::optional<trace::ClockTrace> world;
    if (trace_) {
      world.emplace(trace_->servo(), stalling, "world");
    }
    modes_.PassTo(shell_->recorder());
    task::ServoLoop& loop =
        shell_->BeginLoop(*faulty_arm_, world ? static_cast<hal::Clock&>(*world) : stalling, &modes_);
    if (motion_) {
      loop.UseMotion(*motion_);
    }
    if (live_) {
      live_->Begin({about_, *world_, *faulty_arm_, vision_, *planner_, loop, stalling, {}},
                   [this] { return beliefs_->now(); });
    }
    beliefs_->UseLoop(&loop);
    const hal::Status status = loop.Run(EndNs());
    beliefs_->UseLoop(nullptr);
    if (live_) {
      live_->End();
    }
    shell_->EndLoop();
    stalling_.reset();
    return status;
  }

  [[nodiscard]] bool IsInterrupted() const {
    return options_.interrupt != nullptr && options_.interrupt->Came();
  }

  void EndEarly(bool interrupted) {
    interrupted_ = interrupted;
    stalling_->EndAt(0);
    shell_->loop()->Stop();  // after the current tick, which is still recorded
  }

  // Passes the measurements that are due to the servo. Called between two ticks, on the servo's thread.
  bool HandOver(std::int64_t now_ns, bool wait) {
    if (IsInterrupted() && now_ns < EndNs()) {
      EndEarly(/*interrupted=*/true);
      return true;
    }
    if (wait && verdict_->HasKeptGoalFor(about_.scenario.run.settled_s)) {
      EndEarly(/*interrupted=*/false);
      return true;
    }
    planner_->Act(now_ns, wait);
    if (!trace_) {
      return vision_.HandOver(now_ns, wait, shell_->features());
    }
    const std::int64_t begin_ns = trace::NowNs();
    trace::SinkTrace traced(trace_->servo(), shell_->features());
    const bool open = vision_.HandOver(now_ns, wait, traced);
    trace_->servo().Add({"wait for vision", begin_ns, trace::NowNs(), -1, trace::Flow::kNone});
    return open;
  }

  hal::Status RunInLockstep() {
    LockstepClock clock(*world_, [&](std::int64_t now_ns) {
      const std::int64_t begin_ns = trace_ ? trace::NowNs() : 0;
      TakeRecords();
      if (trace_) {
        trace_->servo().Add({"records", begin_ns, trace::NowNs(), -1, trace::Flow::kNone});
      }
      if (board_ && !board_->failure().empty()) {
        throw std::runtime_error(board_->failure() + "; the arm's brakes were closed");
      }
      if (live_ && !live_->WaitForTick(now_ns, [this] { return IsInterrupted(); })) {
        EndEarly(/*interrupted=*/true);
        return true;
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
    if (!WaitsForFrames()) {
      planner_->Begin();
    }
    std::optional<RealPaceClock> clock;  // its time begins when the thread is ready
    std::jthread servo_thread([&] {      // joins even if the code below throws
      shell_->MakeThreadRealtime({});
      clock.emplace(*world_, sleep ? static_cast<hal::Clock&>(*sleep) : given,
                    [&](std::int64_t now_ns) { return HandOver(now_ns, WaitsForFrames()); });
      status = RunLoop(*clock);
      done = true;
    });
    while (!done) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      TakeRecords();
    }
    servo_thread.join();
    clock->RethrowFailure();
    return status;
  }

  Summary Summarise() {
    Summary s;
    s.scenario = about_.scenario.name;
    s.seed = about_.scenario.run.seed;
    s.truth = about_.truth;
    s.pace = options_.pace == Pace::kReal ? "real" : "lockstep";
    s.sim_time_s = static_cast<double>(world_->now_ns()) * 1e-9;
    shell_->Fill(s);
    files_->Fill(s);
    verdict_->Fill(s);
    s.beliefs = beliefs_->Finish();
    if (theory_) {
      FillTheory(theory_->Finish(), s);
    }
    FillFrameFailures(vision_.failures(), s);
    if (interrupted_) {
      FillInterrupted(s.sim_time_s,
                      live_ ? std::nullopt : std::optional<double>(about_.scenario.run.duration_s), s);
    }
    s.frames_lost = vision_.frames_lost();
    if (board_) {
      s.mcu = board_->Summarise();
    }
    s.wall_time_s = wall_time_s_;
    s.real_time_factor = s.sim_time_s / s.wall_time_s;
    s.renderer = vision_.renderer();
    return s;
  }

  [[nodiscard]] bool HasEye() const { return about_.scenario.camera.enabled; }
  [[nodiscard]] bool WaitsForFrames() const {
    return options_.pace == Pace::kLockstep || options_.clock != nullptr;
  }

  const Instant made_ = std::chrono::steady_clock::now();
  RunOptions options_;
  Progress progress_;
  const RunDescription about_;
  task::ServoTask servo_;
  std::unique_ptr<BoardServo> board_;  // instead of `servo_`
  const StallFault stall_;
  std::optional<StallingClock> stalling_;  // while the loop runs
  std::optional<RunTrace> trace_;
  std::optional<run::RunShell> shell_;
  std::unique_ptr<RunFiles> files_;
  SimVision vision_;  // its thread uses trace_, shell_ and files_
  std::unique_ptr<Verdict> verdict_;
  std::optional<SimPlanner> planner_;
  std::optional<RunBeliefs> beliefs_;
  std::optional<TheoryRun> theory_;
  std::optional<LiveSession> live_;
  std::optional<CommandedMotionSource> motion_;
  ModeWatch modes_;  // for the verdict, which cannot wait for the records
  std::unique_ptr<World> world_;
  std::unique_ptr<SimArm> arm_;
  std::unique_ptr<FaultyArm> faulty_arm_;
  bool interrupted_ = false;  // before the end of the run
  double wall_time_s_ = 0.0;
};

}  // namespace

Summary RunScenario(const Scenario& scenario, const RunOptions& options) {
  return Run(scenario, options).Execute();
}

}  // namespace fovea::sim
