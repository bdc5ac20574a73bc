// Between what the flight recorder keeps and what the log holds.
#pragma once

#include "fovea/flight/flight_recorder.hpp"
#include "fovea/log/tick_message.hpp"
#include "fovea/servo/servo_config.hpp"

namespace fovea::log {
class Keyframe;
class ServoConfiguration;
class Tick;
}  // namespace fovea::log

namespace fovea::flight {

// std::runtime_error: a choice in it that is none.
log::ReplayData ReplayDataOf(const FlightRecord& record);
log::Keyframe ToMessage(const Keyframe& keyframe);
log::ServoConfiguration ToMessage(const servo::ServoConfig& config);

// All below: std::runtime_error when the message is none of this program's.

// The inputs of a tick. `feature`: the measurement that it took, if it took one.
servo::ServoInputs InputsOf(const log::Tick& message, const hal::FeatureMeasurement& feature);
// Fields that this program knows and the log does not have their defaults.
servo::ServoConfig FromMessage(const log::ServoConfiguration& message);
// Into `state`, that of a servo after Init; see link::Decode.
void FromMessage(const log::Keyframe& message, servo::ServoState& state);

}  // namespace fovea::flight
