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

struct HwSummary {
  std::string config;
  servo::LoopCounters loop;
  franka::FrankaCounters robot;
  std::optional<SeenError> seen;  // with a camera
  CameraCounters camera;
  double success_rate = 0.0;  // of commands, by the robot, before the end
  hal::Mode mode = hal::Mode::kBoot;
  hal::Fault fault = hal::Fault::kNone;  // at the end
  std::vector<std::string> events;       // modes, faults and recoveries, in words
  std::vector<std::string> realtime_missing;
  linux_rt::DurationHistogram ticks;
  bool heap_counted = false;
  std::uint64_t heap_calls = 0;
  std::uint64_t page_faults = 0;
};

std::string ToJson(const HwSummary& summary);

}  // namespace fovea::hw
