// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/flight/messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/core/barriers/links_barrier.hpp"
#include "firmware/core/link/config_fields.hpp"
#include "firmware/host/recording/log/log_format.hpp"
#include "fovea/tick.pb.h"

namespace fovea::flight {
namespace {

static_assert(link::kMaxDemand <= std::tuple_size_v<decltype(log::ReplayData::demand)>);

constexpr std::size_t kMostSection = 8192;  // bytes of a part of the configuration

// As link::FieldReader, but fields after the last byte keep their values: the log was written before those
// fields were added to the end of their list.
class EarlierReader {
 public:
  explicit EarlierReader(link::Bytes bytes) : reader_(bytes) {}

  template <class T>
  void operator()(T& value) {
    if (!reader_.Done()) {
      reader_(value);
    }
  }
  template <class Integer>
  void Int(Integer& value) {
    if (!reader_.Done()) {
      reader_.Int(value);
    }
  }
  template <class Integer>
  void Count(Integer& value, int most) {
    if (!reader_.Done()) {
      reader_.Count(value, most);
    }
  }
  template <class Enum>
  void Choice(Enum& value, int count) {
    if (!reader_.Done()) {
      reader_.Choice(value, count);
    }
  }
  [[nodiscard]] bool Done() const { return reader_.Done(); }

 private:
  link::FieldReader reader_;
};

link::Bytes BytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

// Calls `visit(name, fields)` for each part, the arm last.
template <class Config, class Visit>
void EachPart(Config& config, const Visit& visit) {
  link::EachSection(config, visit);
  visit("arm", [&config](auto& a) { link::ArmFields(a, config.arm); });
}

// The largest radius of the bodies `first` to `end` - 1 [m].
double LargestRadius(const model::ArmModel& arm, int first, int end) {
  double largest = 0.0;
  for (int k = std::max(first, 0); k < end; ++k) {
    largest = std::max(largest, arm.shape.bodies[static_cast<std::size_t>(k)].radius);
  }
  return largest;
}

// Clearances of a log before format 3 count from the lines between the joints. This subtracts the links'
// radii, so that no distance becomes larger than it was.
void CountFromCapsules(config::ServoConfig& config) {
  constexpr double kLeastSight = 1e-3;  // 0 would switch the barrier off [m]
  const model::ArmModel& arm = config.arm;
  const int bodies = arm.num_joints + 1;
  config.guard.link_clearance =
      std::max(config.guard.link_clearance - LargestRadius(arm, bodies - barriers::kOuterLinks, bodies), 0.0);
  if (config.guard.sight_clearance > 0.0) {
    config.guard.sight_clearance = std::max(
        config.guard.sight_clearance - LargestRadius(arm, 0, bodies - model::ArmShape::kNeighbours - 1),
        kLeastSight);
  }
}

}  // namespace

log::ReplayData ReplayDataOf(const FlightRecord& record) {
  log::ReplayData data;
  data.state_digest = record.state_digest;
  if (!record.demand.IsPlain()) {
    const link::Bytes bytes = link::Encode(record.demand, data.demand);
    if (bytes.empty()) {
      throw std::runtime_error(fmt::format("tick {}: its request is invalid", record.record.tick));
    }
    data.demand_size = static_cast<std::uint32_t>(bytes.size());
  }
  return data;
}

log::Keyframe ToMessage(const Keyframe& keyframe) {
  std::vector<std::uint8_t> storage(link::kMaxState);
  const link::Bytes bytes = link::Encode(keyframe.state, storage);
  log::Keyframe message;
  message.set_tick(keyframe.tick);
  message.set_state(bytes.data(), bytes.size());
  return message;
}

log::ServoConfiguration ToMessage(const config::ServoConfig& config) {
  log::ServoConfiguration message;
  message.set_format(log::kLogFormat);
  std::vector<std::uint8_t> storage(kMostSection);
  EachPart(config, [&](const char* name, const auto& fields) {
    link::FieldWriter writer(storage);
    fields(writer);
    log::ServoConfiguration::Section& section = *message.add_sections();
    section.set_name(name);
    section.set_fields(writer.written().data(), writer.written().size());
  });
  return message;
}

task::ServoInputs InputsOf(const log::Tick& message, const hal::FeatureMeasurement& feature) {
  const hal::TickRecord record = log::FromMessage(message, feature);
  task::ServoInputs inputs;
  inputs.arm = record.arm;
  inputs.has_feature = record.has_feature;
  inputs.feature = feature;
  inputs.missed_ticks = record.missed_ticks;
  if (!message.demand().empty()) {
    link::Demand demand;
    if (!link::Decode(BytesOf(message.demand()), demand)) {
      throw std::runtime_error(fmt::format("tick {}: its request cannot be read", record.tick));
    }
    const bool ok = demand.arm_status == hal::StatusCode::kOk;
    inputs.arm_status = hal::Status(demand.arm_status, ok ? "" : "arm");
    inputs.request = demand.request;
    inputs.motion = demand.motion;
    inputs.change_law = demand.change_law;
    inputs.law = demand.law;
    inputs.tuning = demand.tuning;
    inputs.plan = demand.plan;
  }
  return inputs;
}

config::ServoConfig FromMessage(const log::ServoConfiguration& message) {
  config::ServoConfig config;
  for (const log::ServoConfiguration::Section& section : message.sections()) {
    bool known = false;
    EachPart(config, [&](const char* name, const auto& fields) {
      if (section.name() == name) {
        EarlierReader reader(BytesOf(section.fields()));
        fields(reader);
        known = reader.Done();
      }
    });
    if (!known) {
      throw std::runtime_error(
          fmt::format("part \"{}\" of the servo's configuration is unknown here: its log has format {}, this "
                      "program's is {}",
                      section.name(), message.format(), log::kLogFormat));
    }
  }
  if (message.format() < 3) {
    CountFromCapsules(config);
  }
  return config;
}

void FromMessage(const log::Keyframe& message, task::ServoState& state) {
  if (!link::Decode(BytesOf(message.state()), state)) {
    throw std::runtime_error(fmt::format("the keyframe of tick {} is not of log format {}, this program's",
                                         message.tick(), log::kLogFormat));
  }
}

}  // namespace fovea::flight
