// SPDX-License-Identifier: Apache-2.0
// Converts between the servo's records and the log's messages, bit-exact in both directions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "fovea/hal/record.hpp"

namespace fovea::log {

// Data for a replay beside the record; see Tick in firmware/host/recording/log/proto/fovea/tick.proto.
struct ReplayData {
  std::uint32_t demand_size = 0;  // [bytes]
  std::array<std::uint8_t, 784> demand{};
  std::optional<std::uint64_t> state_digest;
};

class Feature;
class Tick;
class Tuning;
class Way;

// `message` may be reused: its old content is replaced.
void ToMessage(const hal::TickRecord& record, Tick& message);
void ToMessage(const ReplayData& data, Tick& message);
void ToMessage(const hal::FeatureMeasurement& measurement, Feature& message);

// std::runtime_error when the message cannot have come from ToMessage (more entries than the servo has).
hal::FeatureMeasurement FromMessage(const Feature& message);
// `feature`: the last measurement that was taken; the record repeats it.
hal::TickRecord FromMessage(const Tick& message, const hal::FeatureMeasurement& feature);

// "servo.lambda 2 -> 4 1/s, in motion", with the reason if the request was refused.
std::string InWords(const Tuning& tuning);
// "a plan to the goal came"; "" if nothing happened to a plan.
std::string InWords(const Way& way);

}  // namespace fovea::log
