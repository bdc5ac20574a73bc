// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/flight/renew.hpp"

#include <optional>
#include <stdexcept>

#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/flight/replay.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/tick_message.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/tick.pb.h"

namespace fovea::flight {
namespace {

log::ReplayData ReplayDataIn(const log::Tick& tick) {
  log::ReplayData data;
  if (tick.demand().size() > data.demand.size()) {
    throw std::runtime_error("a request that is too long");
  }
  data.demand_size = static_cast<std::uint32_t>(tick.demand().size());
  std::copy(tick.demand().begin(), tick.demand().end(), data.demand.begin());
  return data;  // without a digest: the state may have other fields in the next build
}

config::ServoConfig ConfigurationIn(const std::filesystem::path& log) {
  std::optional<config::ServoConfig> config;
  TickVisitor visitor;
  visitor.on_configuration = [&config](const log::ServoConfiguration& message) {
    config = FromMessage(message);
  };
  ReadTicks(log, visitor);
  if (!config) {
    throw std::runtime_error(log.string() + ": holds no configuration of the servo");
  }
  return *config;
}

}  // namespace

void Renew(const std::filesystem::path& path, const std::map<std::string, std::string>& build) {
  const config::ServoConfig servo = ConfigurationIn(path);
  std::filesystem::path beside = path;
  beside += ".new";
  try {
    log::RunLogConfig config;
    config.path = beside;
    config.library = "fovea replay --renew";
    config.arm = servo.arm;
    log::RunLog log(config);
    log.AddMetadata("build", build);
    log.Add(log::kConfigurationTopic, 0, ToMessage(servo));
    ReplayOptions options;
    options.on_tick = [&log](const log::Tick&, const log::Tick& replayed, const hal::TickRecord& record) {
      log.AddTick(record, ReplayDataIn(replayed));
    };
    const ReplayResult result = Replay(path, options);
    if (result.segments.size() != 1 || !result.segments[0].not_replayed.empty() || !result.complete) {
      throw std::runtime_error(path.string() + ": the log is not complete from the first tick on");
    }
    log.Finish();
    std::filesystem::rename(beside, path);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    throw;
  }
}

}  // namespace fovea::flight
