// What a run on hardware came to.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fovea/franka/franka_arm.hpp"
#include "fovea/hal/events.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "fovea/servo/servo_loop.hpp"
#include "hw_vision.hpp"

namespace fovea::hw {

// What the log took, and what found no place in it.
struct LogCounters {
  std::uint64_t ticks_dropped = 0;
  std::uint64_t pictures = 0;
  std::uint64_t pictures_dropped = 0;
  std::uint64_t film_frames_dropped = 0;
  std::vector<std::string> film_errors;  // why there is no film, where there should be one
};

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

struct HwSummary {
  std::string config;
  // How it ended, in words, and whether that is well: no fault at the end, and a target that is tracked is
  // seen at its goal. Nobody but the camera says where the target is.
  std::string verdict;
  bool good = false;
  servo::LoopCounters loop;
  franka::FrankaCounters robot;
  std::optional<SeenError> seen;  // with a camera
  CameraCounters camera;
  linux_rt::DurationHistogram feature_ages;  // from exposure to the tick that took the measurement
  double success_rate = 0.0;                 // of commands, by the robot, before the end
  hal::Mode mode = hal::Mode::kBoot;
  hal::Fault fault = hal::Fault::kNone;  // at the end
  std::vector<std::string> events;       // modes, faults and recoveries, in words
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

// Sets verdict and good from all else.
void Judge(HwSummary& summary);

std::string ToJson(const HwSummary& summary);

}  // namespace fovea::hw
