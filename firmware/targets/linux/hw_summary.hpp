// What a run on hardware came to.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/run/run_figures.hpp"
#include "firmware/targets/linux/gravity_check.hpp"
#include "firmware/targets/linux/hw_vision.hpp"
#include "firmware/targets/linux/robots/arm_driver.hpp"
#include "fovea/hal/events.hpp"
#include "fovea/linux_rt/tick_meter.hpp"

namespace fovea::hw {

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

struct HwSummary : run::RunFigures {
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
  std::uint64_t dead_man_holds = 0;      // times that the leave to move ran out
  std::uint64_t lines_unsaid = 0;        // that standard error did not take
  RobotFigures robot;
  std::optional<SeenError> seen;  // with a camera
  CameraCounters camera;
  std::map<std::string, std::uint64_t> measurements;  // how many, by what became of them (hal::Intake)
  linux_rt::DurationHistogram feature_ages;           // from exposure to the tick that took the measurement
  // At the end, before the arm was brought to rest for it.
  hal::Mode mode = hal::Mode::kBoot;
  hal::HoldReason hold_reason = hal::HoldReason::kNone;
  hal::Fault fault = hal::Fault::kNone;
  std::optional<double> finish_t_s;  // since when it was, in the servo's time
  std::vector<std::string> events;   // modes, faults and recoveries, in words
  std::vector<ModeEvent> modes;
  std::vector<FaultEvent> faults;
};

// Sets verdict and converged from all else.
void Judge(HwSummary& summary);

std::string ToJson(const HwSummary& summary);

}  // namespace fovea::hw
