// SPDX-License-Identifier: Apache-2.0
// Golden logs: the servo must reproduce its recorded behaviour. After an intended change `fovea replay <log>
// --renew` rewrites the log, and the commit names the change.
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>
#include <optional>

#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "tests/host/recording/flight/recorded_run.hpp"
#include "tests/support/places.hpp"
#include "tests/support/program.hpp"

namespace fovea::test {
namespace {

namespace fs = std::filesystem;

// All modes in about a second: boot, hold, track, missing states, coast, hold, a commanded goal with a change
// of the motion law, home, a fault, reset.
ServoRun Tour() {
  config::ServoConfig config = PandaConfig();
  config.predict.stale_s = 0.1;
  config.predict.coast_s = 0.15;
  return RunOnIdealArm("tour", config, 1050, true, [&config](int k, task::ServoInputs& inputs) {
    if (k > 440 && k < 448) {
      inputs.arm_status = hal::Status(hal::StatusCode::kTimeout, "arm");
    }
    inputs.missed_ticks = k == 460 ? 2 : 0;
    inputs.has_feature = inputs.has_feature && k < 500;
    if (k > 660 && k < 800) {
      inputs.motion.kind = moves::MotionKind::kJointGoal;
      inputs.motion.q = config.arm.q_ready;
      inputs.motion.q[2] += 0.1;
    } else if (k >= 800 && k < 900) {
      inputs.motion.kind = moves::MotionKind::kHome;
    }
    inputs.change_law = k == 700;
    inputs.law = config::MotionLawKind::kJointImpedance;
    if (k >= 950 && k < 958) {
      inputs.arm.q[3] = std::nan("");
    }
    if (k == 655 || k == 900) {
      inputs.request = task::Request::kHold;
    } else if (k == 980) {
      inputs.request = task::Request::kReset;
    }
  });
}

ServoRun Triangle() {
  return TrackingRun("triangle", hal::FeatureKind::kTriangle, features::FeatureForm::kPose, 600);
}

class GoldenLog : public testing::TestWithParam<ServoRun (*)()> {};

TEST_P(GoldenLog, ServoReproducesTheGoldenLog) {
  const ServoRun run = GetParam()();
  const fs::path log = SourceRoot() / "tests/host/recording/flight/golden" / (run.name + ".mcap");
  if (!fs::exists(log)) {
    fs::create_directories(log.parent_path());
    RecordRun(run, log);
    FAIL() << log << " was missing; it is written now: commit it";
  }
  EXPECT_LT(fs::file_size(log), 700'000U);
  const ProgramResult replay = RunProgram({FOVEA_PROGRAM, "replay", log});
  std::cout << replay.out;
  EXPECT_EQ(replay.exit_code, 0) << "the servo's behaviour has changed. If that is intended: fovea replay "
                                 << log.string() << " --renew\n"
                                 << replay.out << replay.err;
}

INSTANTIATE_TEST_SUITE_P(Runs, GoldenLog, testing::Values(&Tour, &Triangle),
                         [](const auto& run) { return run.index == 0 ? "Tour" : "Triangle"; });

// The log was written before the limit of a disc's tilt existed. A field that the log lacks keeps its
// default; the others are read into the right fields.
TEST(GoldenConfiguration, KeyMissingFromAnOldLogKeepsItsMeaning) {
  std::optional<config::ServoConfig> config;
  flight::TickVisitor visitor;
  visitor.on_configuration = [&config](const log::ServoConfiguration& message) {
    config = flight::FromMessage(message);
  };
  flight::ReadTicks(SourceRoot() / "tests/host/recording/flight/golden" / "triangle.mcap", visitor);
  ASSERT_TRUE(config.has_value());
  EXPECT_EQ(config->guard.view.disc_cosine_min, 0.0);
  EXPECT_EQ(config->guard.workspace_margin, Triangle().config.guard.workspace_margin);
}

// A renewed log keeps its old configuration, unless a change of the format converts it.
TEST(GoldenConfiguration, TourHasTheConfigurationOfToday) {
  std::string logged;
  flight::TickVisitor visitor;
  visitor.on_configuration = [&logged](const log::ServoConfiguration& message) {
    logged = message.SerializeAsString();
  };
  flight::ReadTicks(SourceRoot() / "tests/host/recording/flight/golden" / "tour.mcap", visitor);
  EXPECT_EQ(logged, flight::ToMessage(Tour().config).SerializeAsString())
      << "remove the log and run this test, which writes it";
}

// The tour passes through all modes.
TEST(GoldenTour, PassesThroughEveryMode) {
  const ServoRun run = Tour();
  task::ServoTask task;
  ASSERT_TRUE(task.Init(run.config).ok());
  task::ServoOutputs outputs;
  int modes = 0;
  for (const task::ServoInputs& inputs : run.inputs) {
    task.Step(inputs, outputs);
    modes |= 1 << static_cast<int>(outputs.record.mode);
  }
  EXPECT_EQ(modes, 0b111111) << "boot, hold, track, coast, fault, move";
}

// --renew repairs a log after a change of the servo and keeps its inputs.
TEST(GoldenLogRenewed, RenewedLogReplaysIdentically) {
  const TempFolder folder;
  const std::string log = folder.path() / "log.mcap";
  ServoRun run = TrackingRun("sphere", hal::FeatureKind::kSphere, features::FeatureForm::kSphere, 700);
  // Recorded with another gain than the log states, as if the servo had changed since.
  {
    ServoRun other = run;
    other.config.law.lambda = 1.5;
    RecordRun(other, log, {.configuration = run.config});
  }
  const ProgramResult differs = RunProgram({FOVEA_PROGRAM, "replay", log});
  EXPECT_EQ(differs.exit_code, 1);
  EXPECT_NE(differs.out.find("differs at tick "), std::string::npos) << differs.out;
  EXPECT_NE(differs.out.find("dq_cmd[0]"), std::string::npos) << differs.out;
  const ProgramResult renewed = RunProgram({FOVEA_PROGRAM, "replay", log, "--renew"});
  EXPECT_EQ(renewed.exit_code, 0) << renewed.err;
  const ProgramResult same = RunProgram({FOVEA_PROGRAM, "replay", log});
  EXPECT_EQ(same.exit_code, 0) << same.out;
  EXPECT_NE(same.out.find("700 ticks replayed, recorded by this build"), std::string::npos) << same.out;
}

}  // namespace
}  // namespace fovea::test
