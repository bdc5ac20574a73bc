// Between what the servo records and what the log holds; no bit is lost on the way, in either direction.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "fovea/hal/record.hpp"

namespace fovea::log {

// What a replay needs beside the record; see Tick in firmware/host/recording/log/proto/fovea/tick.proto.
struct ReplayData {
  std::uint32_t demand_size = 0;  // [bytes]
  std::array<std::uint8_t, 320> demand{};
  std::optional<std::uint64_t> state_digest;
};

class Feature;
class Tick;

// `message` may be one that is used again.
void ToMessage(const hal::TickRecord& record, Tick& message);
void ToMessage(const ReplayData& data, Tick& message);
void ToMessage(const hal::FeatureMeasurement& measurement, Feature& message);

// std::runtime_error when the message cannot have come from ToMessage (more entries than the servo has).
hal::FeatureMeasurement FromMessage(const Feature& message);
// `feature`: the last one that was taken, which the record repeats.
hal::TickRecord FromMessage(const Tick& message, const hal::FeatureMeasurement& feature);

}  // namespace fovea::log
