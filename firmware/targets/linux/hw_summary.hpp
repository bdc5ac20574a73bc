// SPDX-License-Identifier: Apache-2.0
// The result of a run on hardware.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/host/beliefs/belief.hpp"
#include "firmware/host/run/fault_event.hpp"
#include "firmware/host/run/run_figures.hpp"
#include "firmware/targets/linux/gravity_check.hpp"
#include "firmware/targets/linux/hw_vision.hpp"
#include "firmware/targets/linux/robots/arm_driver.hpp"
#include "fovea/hal/events.hpp"
#include "fovea/linux_rt/tick_meter.hpp"

namespace fovea::hw {

// A mode and its hold reason. Includes the modes while the arm is brought to rest at the end.
struct ModeEvent {
  double t_s = 0.0;  // since the servo's first tick
  hal::Mode mode = hal::Mode::kBoot;
  hal::HoldReason reason = hal::HoldReason::kNone;
};

// A request of the operator, by a word or by a signal.
struct WordEvent {
  std::int64_t stamp_ns = 0;  // of the loop's clock
  std::string word;
};

struct HwSummary : run::RunFigures {
  std::string config;
  // How the run ended, as text, and whether the target reached its goal according to the camera. True: the
  // camera sees it there at the end. False: the servo should track it and it is not there, the target was
  // never seen, the servo never began, or a fault remains. None: nobody requested tracking.
  std::string verdict;
  std::optional<bool> converged;
  bool allow_motion = true;
  std::string refusal;                    // why motion is refused; "" if it is not
  std::optional<GravityFinding> gravity;  // the last comparison
  bool robot_silent = false;              // no new state for some ticks, up to the end
  bool operator_silent = false;           // the arm is held since the operator's silence; no new request yet
  std::vector<WordEvent> words;
  std::optional<std::int64_t> start_ns;  // of the servo's first tick, by the loop's clock
  std::uint64_t dead_man_holds = 0;      // times that the permission to move ran out
  std::uint64_t lines_unsaid = 0;        // lines that standard error did not take
  RobotFigures robot;
  std::optional<SeenError> seen;  // with a camera
  CameraCounters camera;
  std::optional<beliefs::Findings> beliefs;           // what the run tells of them; none without a camera
  std::map<std::string, std::uint64_t> measurements;  // counts by the name of hal::Intake
  linux_rt::DurationHistogram feature_ages;           // from exposure to the tick that took the measurement
  // At the end of the run, before the arm was brought to rest.
  hal::Mode mode = hal::Mode::kBoot;
  hal::HoldReason hold_reason = hal::HoldReason::kNone;
  hal::Fault fault = hal::Fault::kNone;
  std::optional<double> finish_t_s;  // when that began, since the servo's first tick
  std::vector<std::string> events;   // modes, faults and recoveries, as text
  std::vector<ModeEvent> modes;
  std::vector<run::FaultEvent> faults;
};

// Computes `verdict` and `converged` from the other fields.
void Judge(HwSummary& summary);

std::string ToJson(const HwSummary& summary);

}  // namespace fovea::hw
