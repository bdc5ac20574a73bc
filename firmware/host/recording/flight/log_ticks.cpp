// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/flight/log_ticks.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "firmware/host/recording/log/tick_message.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/tick.pb.h"

namespace fovea::flight {
namespace {

// Joins each tick with its measurement, which follows it in the log.
class Joiner {
 public:
  explicit Joiner(const TickVisitor& visitor) : visitor_(visitor) {}

  void Take(const log::McapMessage& message) {
    if (message.topic == log::kTickTopic) {
      Parse(message, tick_);
      waits_ = tick_.has_feature();
      if (!waits_) {
        Give();
      }
    } else if (message.topic == log::kFeatureTopic) {
      log::Feature feature;
      Parse(message, feature);
      if (waits_ && message.time_ns == tick_.stamp_ns()) {
        feature_ = log::FromMessage(feature);
        waits_ = false;
        Give();
      }
    } else if (message.topic == log::kKeyframeTopic && visitor_.on_keyframe) {
      log::Keyframe keyframe;
      Parse(message, keyframe);
      visitor_.on_keyframe(keyframe);
    } else if (message.topic == log::kConfigurationTopic && visitor_.on_configuration) {
      log::ServoConfiguration configuration;
      Parse(message, configuration);
      visitor_.on_configuration(configuration);
    } else if (visitor_.on_other) {
      visitor_.on_other(message);
    }
  }

 private:
  template <class Message>
  static void Parse(const log::McapMessage& from, Message& to) {
    if (!to.ParseFromArray(from.data.data(), static_cast<int>(from.data.size()))) {
      throw std::runtime_error(fmt::format("a message of {} cannot be parsed", from.topic));
    }
  }
  void Give() const {
    if (visitor_.on_tick) {
      visitor_.on_tick(tick_, feature_);
    }
  }

  const TickVisitor& visitor_;
  log::Tick tick_;
  hal::FeatureMeasurement feature_;
  bool waits_ = false;  // tick_ waits for its measurement
};

}  // namespace

log::McapEnd ReadTicks(const std::filesystem::path& path, const TickVisitor& visitor) {
  Joiner joiner(visitor);
  log::McapVisitor all;
  all.on_message = [&joiner](const log::McapMessage& message) { joiner.Take(message); };
  if (visitor.on_metadata) {
    all.on_metadata = [&visitor](std::string_view name, const std::map<std::string, std::string>& entries) {
      visitor.on_metadata(std::string(name), entries);
    };
  }
  return log::ReadMcap(path, all);
}

std::filesystem::path LogIn(const std::filesystem::path& log_or_folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(log_or_folder, ignored)) {
    return log_or_folder;
  }
  std::filesystem::path whole = log_or_folder / "log.mcap";
  std::filesystem::path broken_off = log_or_folder / ".log.mcap.partial";
  return !std::filesystem::exists(whole, ignored) && std::filesystem::exists(broken_off, ignored) ? broken_off
                                                                                                  : whole;
}

}  // namespace fovea::flight
