#include "hw_run.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include "fovea/flight/flight_recorder.hpp"
#include "fovea/linux_rt/heap_counter.hpp"
#include "fovea/linux_rt/monotonic_clock.hpp"
#include "fovea/linux_rt/realtime.hpp"
#include "fovea/linux_rt/signal_queue.hpp"
#include "fovea/log/record_hash.hpp"
#include "hw_files.hpp"
#include "operator_input.hpp"

namespace fovea::hw {
namespace {

constexpr std::size_t kRingCapacity = 8192;  // records; eight seconds
constexpr int kLookMs = 20;

// Tells changes of mode, and faults, as they come by.
class Watch {
 public:
  Watch(HwSummary& summary, const std::function<void(const std::string&)>& say)
      : summary_(summary), say_(say) {}

  void Add(const hal::TickRecord& record) {
    start_ns_ = start_ns_ < 0 ? record.stamp_ns : start_ns_;
    if (awaited_ && record.arm.sequence != sequence_) {
      awaited_ = false;
      back_ = true;
    }
    sequence_ = record.arm.sequence;
    if (record.has_feature) {
      summary_.feature_ages.Add(record.stamp_ns - record.feature.stamp_ns);
    }
    if (record.mode != summary_.mode || record.fault != summary_.fault) {
      summary_.mode = record.mode;
      summary_.fault = record.fault;
      const bool faulty = record.fault != hal::Fault::kNone;
      Say(fmt::format("{}{}{}", hal::Name(record.mode), faulty ? ": " : "",
                      faulty ? hal::Name(record.fault) : ""));
      if (faulty) {
        summary_.faults.push_back({Seconds(record), record.fault, record.fault_joint});
      }
    }
    if (summary_.modes.empty() || record.mode != summary_.modes.back().mode ||
        record.hold_reason != summary_.modes.back().reason) {
      summary_.modes.push_back({Seconds(record), record.mode, record.hold_reason});
    }
  }
  // Whether the arm's states come anew; true once after each AwaitArm.
  bool ArmIsBack() { return std::exchange(back_, false); }
  void AwaitArm() { awaited_ = true; }
  void Say(const std::string& line) {
    summary_.events.push_back(line);
    say_(line);
  }

 private:
  [[nodiscard]] double Seconds(const hal::TickRecord& record) const {
    return 1e-9 * static_cast<double>(record.stamp_ns - start_ns_);
  }

  HwSummary& summary_;
  const std::function<void(const std::string&)>& say_;
  std::int64_t start_ns_ = -1;  // of the first tick
  std::uint64_t sequence_ = 0;  // of the arm's newest state
  bool awaited_ = false;
  bool back_ = false;
};

// Everything of one run, wired up. Members stand in the order in which one needs the other.
class Session {
 public:
  Session(const HwConfig& config, const HwRunOptions& options,
          const std::function<void(const std::string&)>& say)
      : config_(config),
        options_(options),
        say_(say),
        robot_(LoadHwRobot(config)),
        servo_(MakeHwServoConfig(config, robot_)),
        watch_(summary_, say),
        by_robot_(config.robot.time == "robot"),
        clock_(by_robot_ ? static_cast<hal::Clock&>(robot_clock_) : monotonic_),
        enabled_(options.enable || !options.allow_motion),
        recorder_(task_, options.out.empty() ? nullptr : &task_, kRingCapacity) {
    // Checked by MakeServoConfig already; it is refused there, in words.
    static_cast<void>(task_.Init(servo_));
    summary_.config = config.name;
    if (!options.out.empty()) {
      files_.emplace(options.out, config, robot_, servo_, options.duration_s);
    }
    if (config.HasCamera()) {
      vision_.emplace(config, servo_.feature, clock_.NowNs(), features_,
                      [this](const hal::Frame& frame, const vision::Detection& detection) {
                        if (files_) {
                          files_->AddFrame(frame, detection);
                        }
                      });
      say(fmt::format("camera: {}", vision_->name()));
    }
  }

  HwSummary Execute() {
    std::jthread thread([this] { RunServo(); });
    while (!connected_ && !done_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (connected_) {
      say_(fmt::format("connected to {}:{}{}", config_.robot.host, config_.robot.port,
                       options_.allow_motion ? "" : ", without leave to move"));
      if (!enabled_) {
        say_("the robot holds by itself; \"enable\" lets the servo move it");
      }
    }
    while (!done_) {
      HearSignals();
      HearOperator();
      TakeRecords();
      LookAtCamera();
      if (watch_.ArmIsBack()) {  // before that the servo would find the same fault again
        loop_->Ask(servo::Request::kReset);
      }
    }
    thread.join();
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    Summarise();
    return std::move(summary_);
  }

 private:
  // The real-time thread.
  void RunServo() {
    summary_.realtime_missing =
        linux_rt::MakeThreadRealtime({.fifo_priority = config_.loop.priority, .cpu = config_.loop.cpu});
    // Last of all: from now on the robot sends a state each millisecond.
    try {
      arm_.emplace(MakeFrankaConfig(config_, options_.allow_motion), by_robot_ ? &robot_clock_ : nullptr);
    } catch (...) {
      failure_ = std::current_exception();
      done_ = true;
      return;
    }
    loop_.emplace(recorder_, *arm_, clock_, features_, recorder_, meter_);
    if (options_.track) {
      loop_->Ask(servo::Request::kTrack);
    }
    connected_ = true;
    hal::ArmState state;
    while (!enabled_ && !ended_) {  // the states are read, so that the newest is at hand
      if (!arm_->Read(state).ok()) {
        static_cast<void>(clock_.WaitUntil(clock_.NowNs() + hal::kTickPeriodNs));
      }
    }
    if (!ended_) {
      const std::int64_t end_ns =
          options_.duration_s > 0.0
              ? clock_.NowNs() +
                    static_cast<std::int64_t>(options_.duration_s * static_cast<double>(hal::kNsPerSecond))
              : std::numeric_limits<std::int64_t>::max();
      status_ = loop_->Run(end_ns);
    }
    summary_.success_rate = arm_->robot_state().control_command_success_rate;
    arm_->Stop();
    done_ = true;
  }

  void End() {
    watch_.Say("told to end");
    ended_ = true;
    loop_->Stop();
  }

  void Recover() {
    watch_.Say("told to recover");
    arm_->AskRecovery();
    watch_.AwaitArm();
  }

  void HearSignals() {
    const int signal = signals_.Next(kLookMs);
    if (signal == SIGINT || signal == SIGTERM) {
      End();
    } else if (signal == SIGUSR1) {
      Recover();
    }
  }

  void HearOperator() {
    while (const std::optional<Word> word = operator_.Next()) {
      silence_told_ = false;
      if (*word == Word::kEnable) {
        enabled_ = true;
        watch_.Say("enabled");
      } else if (*word == Word::kTrack) {
        loop_->Ask(servo::Request::kTrack);
      } else if (*word == Word::kHold) {
        loop_->Ask(servo::Request::kHold);
      } else if (*word == Word::kRecover) {
        Recover();
      } else if (*word == Word::kEnd) {
        End();
      } else if (const std::string line = operator_.TakeUnknown(); !line.empty()) {
        say_(fmt::format("\"{}\" is not known; enable, track, hold, recover, end", line));
      }
    }
    if (config_.input.dead_man_s > 0.0 && enabled_ && !silence_told_ &&
        operator_.silent_s() > config_.input.dead_man_s) {
      silence_told_ = true;
      watch_.Say("the operator is silent: hold");
      loop_->Ask(servo::Request::kHold);
    }
  }

  void TakeRecords() {
    const auto take = [this](const flight::FlightRecord& flown) {
      watch_.Add(flown.record);
      hash_.Add(flown.record);
      if (files_) {
        files_->AddRecord(flown);
      }
    };
    recorder_.Drain(take, [this](const flight::Keyframe& keyframe) {
      if (files_) {
        files_->AddKeyframe(keyframe);
      }
    });
  }

  void LookAtCamera() {
    if (vision_ && !camera_failed_ && !vision_->failure().empty()) {
      camera_failed_ = true;
      watch_.Say(fmt::format("the camera: {}", vision_->failure()));
    }
  }

  void Summarise() {
    TakeRecords();
    if (!status_.ok()) {
      watch_.Say(fmt::format("the loop ended: {} ({})", hal::ToString(status_.code()), status_.where()));
    }
    if (arm_->phase() == franka::MotionPhase::kFailed) {
      watch_.Say(fmt::format("the robot: {}", arm_->failure()));
    }
    for (const std::string& line : summary_.realtime_missing) {
      say_("real time: " + line);
    }
    if (vision_) {
      summary_.camera = vision_->Finish();
      summary_.seen = vision_->seen();
    }
    summary_.loop = loop_->counters();
    summary_.robot = arm_->counters();
    summary_.ticks = meter_.durations();
    summary_.heap_counted = linux_rt::HeapCounterActive();
    summary_.heap_calls = meter_.heap_calls();
    summary_.page_faults = meter_.page_faults();
    summary_.records_dropped = recorder_.dropped();
    summary_.log_hash = hash_.Finish();
    Judge(summary_);
    if (files_) {
      summary_.log = files_->EndFilm();
      for (const std::string& error : summary_.log->film_errors) {
        watch_.Say(error);
      }
      files_->Write(summary_);
    }
  }

  const HwConfig& config_;
  const HwRunOptions options_;
  const std::function<void(const std::string&)>& say_;
  const robots::Robot robot_;
  const servo::ServoConfig servo_;
  HwSummary summary_;
  Watch watch_;
  const linux_rt::SignalQueue signals_{SIGINT, SIGTERM, SIGUSR1};
  OperatorInput operator_;
  servo::ServoTask task_;
  franka::RobotClock robot_clock_;
  linux_rt::MonotonicClock monotonic_;
  const bool by_robot_;
  hal::Clock& clock_;
  std::atomic<bool> enabled_;
  std::atomic<bool> connected_{false};  // arm_ and loop_ are there
  std::atomic<bool> ended_{false};
  std::atomic<bool> done_{false};
  bool silence_told_ = false;
  bool camera_failed_ = false;
  hal::FeatureMailbox features_;
  std::optional<HwFiles> files_;  // the vision thread uses it
  std::optional<HwVision> vision_;
  std::optional<franka::FrankaArm> arm_;
  flight::FlightRecorder recorder_;
  linux_rt::TickMeter meter_;
  log::RecordHash hash_;
  std::optional<servo::ServoLoop> loop_;
  hal::Status status_;
  std::exception_ptr failure_;  // why there is no connection
};

}  // namespace

HwSummary Run(const HwConfig& config, const HwRunOptions& options,
              const std::function<void(const std::string&)>& say) {
  return Session(config, options, say).Execute();
}

}  // namespace fovea::hw
