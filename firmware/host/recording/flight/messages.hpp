// SPDX-License-Identifier: Apache-2.0
// Converts between the flight recorder's records and the log's messages.
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

// std::runtime_error: an enumerator in the record is invalid.
log::ReplayData ReplayDataOf(const FlightRecord& record);
log::Keyframe ToMessage(const Keyframe& keyframe);
log::ServoConfiguration ToMessage(const config::ServoConfig& config);

// All below: std::runtime_error when the message does not fit this program.

// The inputs of a tick. `feature`: the measurement that the tick took, if any.
task::ServoInputs InputsOf(const log::Tick& message, const hal::FeatureMeasurement& feature);
// Fields that are missing in the log keep their defaults.
config::ServoConfig FromMessage(const log::ServoConfiguration& message);
// Decodes into `state`, which must be the state of a servo after Init; see link::Decode.
void FromMessage(const log::Keyframe& message, task::ServoState& state);

}  // namespace fovea::flight
