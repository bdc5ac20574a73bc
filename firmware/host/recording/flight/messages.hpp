// Between what the flight recorder keeps and what the log holds.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/recording/log/tick_message.hpp"

namespace fovea::log {
class Keyframe;
class ServoConfiguration;
class Tick;
}  // namespace fovea::log

namespace fovea::flight {

// std::runtime_error: a choice in it that is none.
log::ReplayData ReplayDataOf(const FlightRecord& record);
log::Keyframe ToMessage(const Keyframe& keyframe);
log::ServoConfiguration ToMessage(const config::ServoConfig& config);

// All below: std::runtime_error when the message is none of this program's.

// The inputs of a tick. `feature`: the measurement that it took, if it took one.
task::ServoInputs InputsOf(const log::Tick& message, const hal::FeatureMeasurement& feature);
// Fields that this program knows and the log does not have their defaults.
config::ServoConfig FromMessage(const log::ServoConfiguration& message);
// Into `state`, that of a servo after Init; see link::Decode.
void FromMessage(const log::Keyframe& message, task::ServoState& state);

}  // namespace fovea::flight
