// SPDX-License-Identifier: Apache-2.0
// Writes a run's log without a simulator: the servo steps through given inputs, wrapped by the flight
// recorder, and the log's own thread writes.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/tick.pb.h"
#include "tests/support/servo_runs.hpp"

namespace fovea::test {

inline std::map<std::string, std::string> ThisBuild() {
  return {{"servo library", "of this test"}, {"link library", "of this test, too"}};
}

struct RecordedRunOptions {
  std::size_t ring = 4096;                             // size of the recorder's ring
  std::function<bool(std::size_t tick)> is_drained{};  // whether to drain after this tick; empty: after each
  std::optional<config::ServoConfig> configuration{};  // stated in the log; none: the run's
};

// Returns the number of dropped records.
inline std::uint64_t RecordRun(const ServoRun& run, const std::filesystem::path& path,
                               const RecordedRunOptions& options = {}) {
  task::ServoTask task;
  EXPECT_TRUE(task.Init(run.config).ok());
  flight::FlightRecorder recorder(task, &task, options.ring);
  log::RunLogConfig config;
  config.path = path;
  config.library = "test";
  config.arm = run.config.arm;
  log::RunLog log(config);
  log.AddMetadata("build", ThisBuild());
  log.Add(log::kConfigurationTopic, 0, flight::ToMessage(options.configuration.value_or(run.config)));
  const auto drain = [&] {
    recorder.Drain([&](const flight::FlightRecord& r) { log.AddTick(r.record, flight::ReplayDataOf(r)); },
                   [&](const flight::Keyframe& keyframe) {
                     log.Add(log::kKeyframeTopic, keyframe.state.now_ns, flight::ToMessage(keyframe));
                   });
  };
  task::ServoOutputs outputs;
  for (std::size_t k = 0; k < run.inputs.size(); ++k) {
    recorder.Step(run.inputs[k], outputs);
    recorder.Record(outputs.record);
    if (!options.is_drained || options.is_drained(k)) {
      drain();
    }
  }
  drain();
  log.Finish();
  return recorder.dropped();
}

}  // namespace fovea::test
