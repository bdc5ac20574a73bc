// What a run on hardware is about, for what it leaves behind.
#pragma once

#include "firmware/host/robots/robot.hpp"
#include "firmware/host/run/run_book.hpp"
#include "firmware/targets/linux/hw_config.hpp"

namespace fovea::hw {

// `duration_s`: 0 when nobody knows.
run::RunFacts FactsOf(const HwConfig& config, const robots::Robot& robot, const config::ServoConfig& servo,
                      double duration_s);

// Nobody waits for a disk.
run::RunBookOptions BookOptions(const HwConfig& config);

}  // namespace fovea::hw
