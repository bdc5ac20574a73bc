// Between what the servo records and what the log holds; no bit is lost on the way, in either direction.
#pragma once

#include "fovea/hal/record.hpp"

namespace fovea::log {

class Feature;
class Tick;

// `message` may be one that is used again.
void ToMessage(const hal::TickRecord& record, Tick& message);
void ToMessage(const hal::FeatureMeasurement& measurement, Feature& message);

// std::runtime_error when the message cannot have come from ToMessage (more entries than the servo has).
hal::FeatureMeasurement FromMessage(const Feature& message);
// `feature`: the last one that was taken, which the record repeats.
hal::TickRecord FromMessage(const Tick& message, const hal::FeatureMeasurement& feature);

}  // namespace fovea::log
