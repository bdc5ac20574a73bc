// What a run on hardware came to.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/core/task/servo_loop.hpp"
#include "firmware/targets/linux/gravity_check.hpp"
#include "firmware/targets/linux/hw_vision.hpp"
#include "fovea/franka/franka_arm.hpp"
#include "fovea/hal/events.hpp"
#include "fovea/linux_rt/tick_meter.hpp"

namespace fovea::hw {

// What the log took, and what found no place in it.
struct LogCounters {
  std::uint64_t ticks_dropped = 0;
  std::uint64_t pictures = 0;
  std::uint64_t pictures_dropped = 0;
  std::uint64_t film_frames_dropped = 0;
  std::vector<std::string> film_errors;  // why there is no film, where there should be one
};

// A mode, and why it holds; those while the arm is brought to rest in the end among them.
struct ModeEvent {
  double t_s = 0.0;  // since the servo's first tick
  hal::Mode mode = hal::Mode::kBoot;
  hal::HoldReason reason = hal::HoldReason::kNone;
};

struct FaultEvent {
  double t_s = 0.0;
  hal::Fault fault = hal::Fault::kNone;
  int joint = -1;  // at fault; -1: none
};

// Something that the operator asked for, in a word or by a signal.
struct WordEvent {
  std::int64_t stamp_ns = 0;  // of the loop's clock
  std::string word;
};

struct HwSummary {
  std::string config;
  // How it ended, in words, and whether the target was followed to its goal, as far as its own camera says:
  // true when it is seen there in the end; false when it was to be and is not, the target was never seen, the
  // servo never began, or a fault is left; none when nobody asked for it.
  std::string verdict;
  std::optional<bool> converged;
  bool allow_motion = true;
  std::string refusal;                    // why motion was refused; "" when it was not, or is no longer
  std::optional<GravityFinding> gravity;  // the last comparison
  bool operator_silent = false;           // the dead man has the arm held, and nobody asked anew
  std::vector<WordEvent> words;
  std::optional<std::int64_t> start_ns;  // of the servo's first tick, by the loop's clock
  std::uint64_t lines_unsaid = 0;        // that standard error did not take
  task::LoopCounters loop;
  franka::FrankaCounters robot;
  std::optional<SeenError> seen;  // with a camera
  CameraCounters camera;
  std::map<std::string, std::uint64_t> measurements;  // how many, by what became of them (hal::Intake)
  linux_rt::DurationHistogram feature_ages;           // from exposure to the tick that took the measurement
  double success_rate = 0.0;                          // of commands, by the robot, before the end
  // At the end, before the arm was brought to rest for it.
  hal::Mode mode = hal::Mode::kBoot;
  hal::HoldReason hold_reason = hal::HoldReason::kNone;
  hal::Fault fault = hal::Fault::kNone;
  std::optional<double> finish_t_s;  // since when it was, in the servo's time
  std::vector<std::string> events;   // modes, faults and recoveries, in words
  std::vector<ModeEvent> modes;
  std::vector<FaultEvent> faults;
  std::uint64_t records_dropped = 0;  // ticks that nobody looked at
  std::string log_hash;               // over all others
  std::optional<LogCounters> log;     // with files
  std::vector<std::string> realtime_missing;
  linux_rt::DurationHistogram ticks;
  bool heap_counted = false;
  std::uint64_t heap_calls = 0;
  std::uint64_t page_faults = 0;
};

// Sets verdict and converged from all else.
void Judge(HwSummary& summary);

std::string ToJson(const HwSummary& summary);

}  // namespace fovea::hw
