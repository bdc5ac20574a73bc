// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/hw_run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <exception>
#include <limits>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "firmware/host/beliefs/finder.hpp"
#include "firmware/host/run/run_shell.hpp"
#include "firmware/planning/plan_desk.hpp"
#include "firmware/targets/linux/await_leave.hpp"
#include "firmware/targets/linux/hw_facts.hpp"
#include "firmware/targets/linux/operator_thread.hpp"
#include "firmware/targets/linux/run_watch.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/linux_rt/signal_queue.hpp"

namespace fovea::hw {
namespace {

constexpr std::size_t kRecords = 8192;  // that may wait: eight seconds at 1 kHz
constexpr std::size_t kFindings = 16;
constexpr std::chrono::milliseconds kLook{10};
constexpr std::chrono::milliseconds kSayLast{300};  // before the summary counts the unprinted lines

// All objects of one run, connected. The order of the members follows their dependencies.
class Session {
 public:
  Session(const HwConfig& config, const HwRunOptions& options, const linux_rt::SignalQueue& signals,
          linux_rt::Speaker& speaker)
      : config_(config),
        options_(options),
        speaker_(speaker),
        robot_(LoadHwRobot(config)),
        servo_(MakeHwServoConfig(config, robot_)),
        watch_(summary_, speaker),
        robot_link_(ArmDriverOf(config).make(config)),
        clock_(robot_link_->robot_time() != nullptr ? *robot_link_->robot_time() : monotonic_),
        live_(options.live ? std::make_unique<HwLive>(*options.live, config.name, servo_, config.HasCamera(),
                                                      config.robot.speed_scale)
                           : nullptr),
        shell_(task_, &task_, kRecords,
               FolderOf(config, robot_, servo_, options.out, options.duration_s, options.command,
                        live_ ? live_->tap() : log::LogTap{})),
        operator_({.dead_man_s = config.input.dead_man_s, .allow_motion = options.allow_motion}, clock_,
                  signals, control_) {
    // MakeServoConfig has checked it already, and throws with a message if it is refused.
    static_cast<void>(task_.Init(servo_));
    summary_.config = config.name;
    summary_.allow_motion = options.allow_motion;
    if (live_) {
      speaker_.Say("live at " + live_->url());
    }
    shell_.OnRecord([this](const flight::FlightRecord& flown) { Observe(flown.record); });
    if (config.HasCamera()) {
      beliefs_.emplace(servo_, ConfiguredBeliefs(config),
                       beliefs::FinderConfig{LearnsOf(config), live_ != nullptr, /*waits=*/false});
      const auto& eye = config.vision.config;
      shell_.UsePlanner(plans_.emplace(servo_, planning::EyeReach{eye.distance_min, eye.distance_max}).box());
      plans_->Begin();
      OpenCamera();
    }
  }

  HwSummary Execute() {
    std::jthread thread([this] { RunServo(); });
    while (!control_.done) {
      std::this_thread::sleep_for(kLook);
      Attend();
    }
    thread.join();
    control_.closing_ns = linux_rt::MonotonicNs();
    Attend();
    if (failure_ && !control_.ended) {
      std::rethrow_exception(failure_);
    }
    Summarise();
    return std::move(summary_);
  }

 private:
  void OpenCamera() {
    try {
      vision_.emplace(config_, servo_.feature, clock_.NowNs(), shell_.features(),
                      [this](const hal::Frame& frame, const vision::Detection& detection) {
                        shell_.AddFrame(frame, detection);
                      });
      speaker_.Say(fmt::format("camera: {}", vision_->name()));
    } catch (const std::exception& error) {
      if (!control_.ended) {
        throw;
      }
      watch_.Say(error.what());
    }
  }

  // The real-time thread.
  void RunServo() {
    shell_.MakeThreadRealtime({.fifo_priority = config_.loop.priority, .cpu = config_.loop.cpu});
    // Connect last: from now on the robot sends a state each millisecond.
    try {
      if (!control_.ended) {
        Connect();
      }
    } catch (...) {
      failure_ = std::current_exception();
    }
    if (control_.loop != nullptr) {
      Serve();
    }
    control_.done = true;
  }

  void Connect() {
    arm_ = &robot_link_->Connect(options_.allow_motion);
    task::ServoLoop& loop = shell_.BeginLoop(*arm_, clock_);
    control_.arm = robot_link_.get();
    control_.loop = &loop;
    if (control_.hold_asked) {  // before there was a loop to ask
      loop.Ask(task::Request::kHold);
    }
    GiveLeave(config_.input.dead_man_s, clock_, control_);
  }

  void Serve() {
    if (!options_.allow_motion ||
        AwaitLeave(config_, robot_.model, options_.enable, *arm_, clock_, control_, findings_)) {
      if (options_.track) {
        shell_.loop()->AskIfNoneWaits(task::Request::kTrack);  // an operator's earlier Hold counts
      }
      RunLoop(*shell_.loop());
    }
    robot_link_->Stop();
  }

  void RunLoop(task::ServoLoop& loop) {
    if (control_.ended) {
      return;
    }
    control_.serves = options_.allow_motion;
    constexpr std::int64_t kForEver = std::numeric_limits<std::int64_t>::max();
    const double duration_ns = options_.duration_s * static_cast<double>(hal::kNsPerSecond);
    status_ =
        loop.Run(duration_ns > 0.0 ? clock_.NowNs() + static_cast<std::int64_t>(duration_ns) : kForEver);
    if (status_.ok() && options_.allow_motion && !control_.ended) {
      loop.Finish();
      status_ = loop.Run(kForEver);
    }
  }

  // In the main thread: handles everything that the other threads put into their rings.
  void Attend() {
    TellConnection();
    findings_.Drain(findings_.End(), [this](const LeaveFinding& finding) {
      Tell(finding, "enable");
      if (finding.passed) {
        watch_.Say("enabled");
      }
    });
    TellLease();
    operator_.Drain([this](const Heard& heard) { Tell(heard); });
    shell_.TakeRecords();
    if (beliefs_) {
      beliefs_->Act();
    }
    if (live_) {
      live_->Attend(beliefs_ ? beliefs_->now() : nullptr);
    }
    EndSilentRun();
    LookAtRecovery();
    LookAtCamera();
    // Without new states the servo would find the same fault again.
    if (watch_.ArmIsBack() && summary_.fault != hal::Fault::kNone) {
      look_.emplace(config_, robot_.model);
    }
  }

  void TellConnection() {
    if (connection_told_ || control_.loop == nullptr) {
      return;
    }
    connection_told_ = true;
    if (beliefs_) {
      beliefs_->UseLoop(control_.loop);
    }
    if (live_) {
      live_->Begin(shell_, control_, options_.allow_motion, clock_,
                   [this](const Heard& heard) { Tell(heard); });
    }
    connected_ns_ = linux_rt::MonotonicNs();
    speaker_.Say(fmt::format("connected to {}{}", robot_link_->address(),
                             options_.allow_motion ? "" : ", without permission to move"));
    if (!options_.allow_motion) {
      return;
    }
    if (!options_.enable) {
      speaker_.Say("the robot holds by itself; \"enable\" lets the servo move it");
    }
    if (config_.input.dead_man_s > 0.0) {
      speaker_.Say(
          fmt::format("type a line at least every {} s to keep the arm moving, otherwise it is held; "
                      "for a run without an operator: --set input.dead_man_s=0",
                      config_.input.dead_man_s));
    }
  }

  // `word`: the operator types it to try again.
  void Tell(const LeaveFinding& finding, const char* word) {
    const std::string words = InWords(finding, config_.check.gravity_torque);
    summary_.refusal = finding.passed ? "" : words;
    if (finding.trouble == nullptr) {
      summary_.gravity = finding.gravity;
    }
    watch_.Say(words);
    if (!finding.passed) {
      speaker_.Say(fmt::format("the robot holds by itself; remove the cause and type \"{}\" again", word));
    }
  }

  // A silent robot that sets the clock (robot_time) stops the loop's time: then the computer's ends the run.
  void EndSilentRun() {
    const double passed_s = 1e-9 * static_cast<double>(linux_rt::MonotonicNs() - connected_ns_);
    if (summary_.robot_silent && options_.duration_s > 0.0 && passed_s >= options_.duration_s &&
        !control_.ended) {
      EndRun(options_.allow_motion, false, control_);
    }
  }

  // For a robot that recovered and holds by itself: the servo takes over again when gravity passes the same
  // check as before the start.
  void LookBeforeReset(const hal::ArmState& state) {
    const bool is_new = std::exchange(looked_at_, state.sequence) != state.sequence;
    if (!look_ || !is_new) {
      return;
    }
    if (const auto finding = look_->Add(hal::Status::Ok(), state)) {
      look_.reset();
      Tell(*finding, "recover");
      if (finding->passed) {
        shell_.loop()->Ask(task::Request::kReset);
        speaker_.Say("recovered: the servo holds; type \"track\" to move again");
      }
    }
  }

  void TellLease() {
    const task::ServoLoop* loop = control_.loop;
    const std::uint64_t ends = loop != nullptr ? loop->lease_ends() : 0;
    if (ends > lease_ends_told_) {
      lease_ends_told_ = ends;
      summary_.operator_silent = true;
      watch_.Say("the operator is silent: hold");
    }
  }

  void Tell(const Heard& heard) {
    if (heard.word == Word::kAlive) {
      if (heard.unknown.front() != 0) {
        speaker_.Say(fmt::format("\"{}\" is not known; allowed: enable, track, hold, recover, end",
                                 heard.unknown.data()));
      }
      return;
    }
    summary_.words.push_back({heard.stamp_ns, Name(heard.word)});
    if (heard.word == Word::kTrack) {
      summary_.operator_silent = false;
    } else if (heard.word == Word::kRecover) {
      watch_.Say("told to recover");
      watch_.AwaitArm();
    } else if (heard.word == Word::kEnd) {
      watch_.Say("told to end");
    }
  }

  void Observe(const hal::TickRecord& record) {
    watch_.Add(record, record.tick >= shell_.loop()->finish_tick());
    if (beliefs_) {
      beliefs_->Add(record);
    }
    if (live_) {
      live_->Note(record);
    }
    LookBeforeReset(record.arm);
  }

  void LookAtRecovery() {
    ArmDriver* robot = control_.arm;
    if (const char* why = robot != nullptr ? robot->TakeRecoveryRefusal() : nullptr) {
      watch_.Say(fmt::format("no recovery: {}; type \"recover\" again", why));
    }
  }

  void LookAtCamera() {
    if (vision_ && !camera_failed_ && !vision_->failure().empty()) {
      camera_failed_ = true;
      watch_.Say(fmt::format("the camera: {}", vision_->failure()));
    }
  }

  void Summarise() {
    // Print these lines before the program waits for any file.
    if (!status_.ok()) {
      watch_.Say(fmt::format("the loop ended: {} ({})", hal::ToString(status_.code()), status_.where()));
    }
    if (const char* why = robot_link_->failure()) {
      watch_.Say(fmt::format("the robot: {}", why));
    }
    for (const std::string& line : shell_.realtime_missing()) {
      speaker_.Say("real time: " + line);
    }
    if (vision_) {
      summary_.camera = vision_->Finish();
      summary_.seen = vision_->seen();
    }
    if (const task::ServoLoop* loop = shell_.loop()) {
      summary_.dead_man_holds = loop->lease_ends();
      summary_.robot = robot_link_->figures();
    }
    if (beliefs_) {
      beliefs_->UseLoop(nullptr);
      summary_.beliefs = beliefs_->Finish();
      for (const std::string& sentence : summary_.beliefs->verdict) {
        watch_.Say("found out: " + sentence);
      }
    }
    shell_.Fill(summary_);
    Judge(summary_);
    for (const std::string& error : summary_.film_errors) {
      watch_.Say(error);
    }
    speaker_.Wait(kSayLast);
    summary_.lines_unsaid = speaker_.unsaid();
    try {
      shell_.Write(ToJson(summary_));
    } catch (const std::exception& error) {
      summary_.files_error = error.what();
    }
  }

  const HwConfig& config_;
  const HwRunOptions options_;
  linux_rt::Speaker& speaker_;
  const robots::Robot robot_;
  const config::ServoConfig servo_;
  HwSummary summary_;
  RunWatch watch_;
  task::ServoTask task_;
  linux_rt::MonotonicClock monotonic_;
  const std::unique_ptr<ArmDriver> robot_link_;
  hal::Clock& clock_;
  RunControl control_;
  LeaveRing findings_{kFindings};
  bool connection_told_ = false;
  std::int64_t connected_ns_ = 0;  // MonotonicNs()
  std::uint64_t lease_ends_told_ = 0;
  bool camera_failed_ = false;
  std::optional<LeaveLook> look_;  // after a recovery
  std::uint64_t looked_at_ = 0;    // sequence of its newest state
  const std::unique_ptr<HwLive> live_;
  run::RunShell shell_;
  std::optional<planning::PlanDesk> plans_;
  std::optional<beliefs::Finder> beliefs_;  // with a camera: what the run tells of the servo's beliefs
  std::optional<HwVision> vision_;          // its thread uses the shell
  hal::Arm* arm_ = nullptr;                 // once connected
  hal::Status status_;
  std::exception_ptr failure_;  // why there is no connection
  OperatorThread operator_;     // last: it uses the loop, the arm and the clock
};

}  // namespace

HwSummary Run(const HwConfig& config, const HwRunOptions& options, linux_rt::Speaker& speaker) {
  // From here on a signal ends the run in order, and a closed pipe does not end it.
  std::signal(SIGPIPE, SIG_IGN);
  const linux_rt::SignalQueue signals{SIGINT, SIGTERM, SIGHUP, SIGUSR1};
  return Session(config, options, signals, speaker).Execute();
}

}  // namespace fovea::hw
