// SPDX-License-Identifier: Apache-2.0
// Replay is bit-exact from the first tick, from each keyframe, around lost ticks and up to the end of a
// truncated file. A difference is found and named.
#include "firmware/host/recording/flight/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>

#include "firmware/host/recording/flight/log_ticks.hpp"
#include "firmware/host/recording/log/mcap_writer.hpp"
#include "tests/host/recording/flight/recorded_run.hpp"
#include "tests/support/temp_folder.hpp"

namespace fovea::flight {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ReplayTest : public testing::Test {
 protected:
  static ReplayOptions Options(double from_s = 0.0) {
    ReplayOptions options;
    options.build = test::ThisBuild();
    options.from_s = from_s;
    return options;
  }
  static test::ServoRun Sphere(int ticks) {
    return test::TrackingRun("sphere", hal::FeatureKind::kSphere, features::FeatureForm::kSphere, ticks);
  }
  // A copy of the log in which `change` has edited each tick, or removed it by returning false.
  fs::path Changed(const std::function<bool(log::Tick&)>& change) const {
    fs::path path = folder_.path() / "changed.mcap";
    log::McapWriter writer(path, "test");
    std::map<std::string, std::uint16_t> channels;
    log::McapVisitor visitor;
    visitor.on_message = [&](const log::McapMessage& m) {
      std::string data(m.data);
      if (m.topic == log::kTickTopic) {
        log::Tick tick;
        ASSERT_TRUE(tick.ParseFromString(data));
        if (!change(tick)) {
          return;
        }
        data = tick.SerializeAsString();
      }
      const std::string topic(m.topic);
      if (channels.count(topic) == 0) {
        channels[topic] = writer.AddChannel(writer.AddSchema(std::string(m.schema), ""), topic);
      }
      writer.Write(channels[topic], m.time_ns, data);
    };
    visitor.on_metadata = [&](std::string_view name, const std::map<std::string, std::string>& entries) {
      writer.WriteMetadata(std::string(name), entries);
    };
    log::ReadMcap(path_, visitor);
    writer.Finish();
    return path;
  }

  const test::TempFolder folder_;
  const fs::path path_ = folder_.path() / "log.mcap";
};

TEST_F(ReplayTest, EveryKindOfRunReplaysBitExact) {
  for (const test::ServoRun& run : test::AllServoRuns()) {
    ASSERT_EQ(test::RecordRun(run, path_), 0U);
    for (const double from_s : {0.0, 0.5, 1.5}) {
      std::uint64_t compared = 0;
      ReplayOptions options = Options(from_s);
      options.on_tick = [&](const auto&, const auto&, const auto&) { ++compared; };
      const ReplayResult result = Replay(path_, options);
      ASSERT_EQ(result.segments.size(), 1U) << run.name;
      const Segment& segment = result.segments[0];
      EXPECT_TRUE(result.Identical())
          << run.name << " from " << from_s << ": "
          << (segment.divergence
                  ? segment.divergence->field + " at " + std::to_string(segment.divergence->tick)
                  : segment.not_replayed);
      const std::uint64_t first = from_s == 0.0 ? 0 : from_s == 0.5 ? 1000 : 2000;
      EXPECT_EQ(segment.first_tick, first);
      EXPECT_EQ(segment.last_tick, run.inputs.size() - 1);
      EXPECT_EQ(compared, run.inputs.size() - first);
      EXPECT_TRUE(result.complete && result.same_build);
    }
    std::cout << run.name << ": " << fs::file_size(path_) << " bytes, " << run.inputs.size() << " ticks\n";
  }
}

// Ticks dropped by a full ring are counted, and split the log at the next keyframe.
TEST_F(ReplayTest, LostTicksSplitTheLogAtTheNextKeyframe) {
  const test::ServoRun run = Sphere(3500);
  test::RecordedRunOptions options;
  options.ring = 100;
  options.is_drained = [](std::size_t tick) { return tick < 1200 || tick > 1650; };
  const std::uint64_t dropped = test::RecordRun(run, path_, options);
  EXPECT_EQ(dropped, 1652U - 1200U - 100U);
  const ReplayResult result = Replay(path_, Options());
  EXPECT_EQ(result.ticks_lost, dropped);
  ASSERT_EQ(result.segments.size(), 3U);
  EXPECT_EQ(result.segments[0].last_tick, 1299U);
  EXPECT_EQ(result.segments[1].not_replayed, "no keyframe at its start");
  EXPECT_EQ(result.segments[1].last_tick, 1999U);
  EXPECT_EQ(result.segments[2].first_tick, 2000U);
  EXPECT_TRUE(result.segments[2].from_keyframe);
  EXPECT_EQ(result.segments[2].last_tick, 3499U);
  EXPECT_TRUE(result.Identical());
  EXPECT_EQ(result.ticks(), 1300U + 1500U);

  // With another build the first segment still replays; the keyframes are not used.
  for (const char* library : {"servo library", "link library"}) {
    ReplayOptions other = Options();
    other.build[library] = "another";
    const ReplayResult by_other = Replay(path_, other);
    EXPECT_FALSE(by_other.same_build);
    EXPECT_TRUE(by_other.Identical());
    EXPECT_EQ(by_other.ticks(), 1300U);
    ASSERT_EQ(by_other.segments.size(), 2U);
    EXPECT_THAT(by_other.segments[1].not_replayed, HasSubstr("only the build that wrote"));
  }
}

TEST_F(ReplayTest, TruncatedFileReplaysUpToTheCut) {
  test::RecordRun(Sphere(2600), path_);
  const auto size = fs::file_size(path_);
  std::uint64_t before = 0;
  int with_ticks = 0;
  for (int i = 1; i < 24; ++i) {
    const fs::path cut = folder_.path() / "cut.mcap";
    fs::copy_file(path_, cut, fs::copy_options::overwrite_existing);
    fs::resize_file(cut, size * static_cast<std::uintmax_t>(i) / 24);
    try {
      const ReplayResult result = Replay(cut, Options());
      EXPECT_FALSE(result.complete);
      EXPECT_THAT(result.why_incomplete, HasSubstr("cut off at byte"));
      EXPECT_TRUE(result.changes.empty());
      EXPECT_GE(result.ticks(), before);
      before = result.ticks();
      with_ticks += before > 0 ? 1 : 0;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("holds nothing to replay")) << i;
      EXPECT_EQ(before, 0U);
    }
  }
  EXPECT_GT(with_ticks, 0);
}

TEST_F(ReplayTest, DifferingOutputIsFoundAndNamed) {
  test::RecordRun(Sphere(1500), path_);
  const fs::path changed = Changed([](log::Tick& tick) {
    if (tick.tick() >= 1234) {
      tick.mutable_command()->set_tau(3, std::nextafter(tick.command().tau(3), 1e9));
    }
    if (tick.tick() == 1300) {
      tick.set_mode(log::FAULT);
    }
    return true;
  });
  const ReplayResult result = Replay(changed, Options());
  EXPECT_FALSE(result.Identical());
  ASSERT_EQ(result.segments.size(), 1U);
  ASSERT_TRUE(result.segments[0].divergence);
  EXPECT_EQ(result.segments[0].divergence->tick, 1234U);
  EXPECT_EQ(result.segments[0].divergence->field, "command.tau[3]");
  EXPECT_NE(result.segments[0].divergence->recorded, result.segments[0].divergence->replayed);
  ASSERT_EQ(result.changes.size(), 2U);
  EXPECT_EQ(result.changes[0].ticks, 1500U - 1234U);
  EXPECT_LT(result.changes[0].most, 1e-12);
  EXPECT_EQ(result.changes[1].field, "mode");
  EXPECT_EQ(result.changes[1].ticks, 1U);
}

// One changed input bit of one tick: the outputs or the digest show it, and
// the next keyframe names the changed part of the state.
TEST_F(ReplayTest, DifferingInputShowsInTheState) {
  test::RecordRun(Sphere(1500), path_);
  const fs::path changed = Changed([](log::Tick& tick) {
    if (tick.tick() == 995) {
      tick.mutable_arm()->set_dq(2, std::nextafter(tick.arm().dq(2), 1e9));
    }
    return true;
  });
  const ReplayResult result = Replay(changed, Options());
  ASSERT_EQ(result.segments.size(), 1U);
  ASSERT_TRUE(result.segments[0].divergence);
  EXPECT_EQ(result.segments[0].divergence->tick, 995U);
  EXPECT_NE(result.segments[0].divergence->state_group, "");
  std::cout << result.segments[0].divergence->field << "; " << result.segments[0].divergence->state_group
            << '\n';
}

TEST_F(ReplayTest, MissingTickIsNoDivergence) {
  test::RecordRun(Sphere(2500), path_);
  const ReplayResult result = Replay(Changed([](log::Tick& tick) { return tick.tick() != 321; }), Options());
  EXPECT_EQ(result.ticks_lost, 1U);
  EXPECT_TRUE(result.Identical());
  ASSERT_EQ(result.segments.size(), 3U);
  EXPECT_EQ(result.segments[2].first_tick, 1000U);
}

// Another gain, in open loop: the outputs change from the first tracking tick. The servo still gets the
// recorded arm states and reports no fault.
TEST_F(ReplayTest, AnotherConfigurationReportsItsChanges) {
  config::ServoConfig still = test::PandaConfig();
  still.law.posture_gain = 0.0;  // only the visual law moves the arm
  const auto as_it_is = [](int, const task::ServoInputs&) {};
  test::RecordRun(test::RunOnIdealArm("sphere", still, 2500, true, as_it_is), path_);
  for (const double from_s : {0.0, 0.5}) {
    ReplayOptions options = Options(from_s);
    double recorded_speed = 0.0;
    double replayed_speed = 0.0;
    options.change = [](config::ServoConfig config) {
      config.law.lambda *= 1.5;
      return config;
    };
    options.on_tick = [&](const log::Tick& recorded, const log::Tick& replayed, const hal::TickRecord&) {
      EXPECT_EQ(recorded.fault(), log::NO_FAULT);
      EXPECT_EQ(replayed.fault(), log::NO_FAULT);
      EXPECT_EQ(recorded.mode(), replayed.mode());
      const auto speed = [](const log::Tick& tick) {
        return std::hypot(tick.v_bc_c_cmd(0), tick.v_bc_c_cmd(1), tick.v_bc_c_cmd(2));
      };
      if (speed(recorded) > 0.02) {  // below, the estimate's noise dominates
        recorded_speed += speed(recorded);
        replayed_speed += speed(replayed);
      }
    };
    const ReplayResult result = Replay(path_, options);
    EXPECT_FALSE(result.Identical());
    std::cout << "with 1.5 times the gain: " << replayed_speed / recorded_speed << " of the speed\n";
    // A replay from a keyframe starts at the recorded speed, while the recorded arm slows down already.
    EXPECT_GT(replayed_speed, (from_s == 0.0 ? 1.4 : 1.1) * recorded_speed);
    EXPECT_LT(replayed_speed, 1.6 * recorded_speed);
  }
  ReplayOptions same = Options();
  same.change = [](const config::ServoConfig& config) { return config; };
  EXPECT_TRUE(Replay(path_, same).Identical());
}

TEST_F(ReplayTest, LogWithoutAFlightRecorderIsRefused) {
  log::McapWriter writer(path_, "test");
  writer.Finish();
  try {
    Replay(path_, Options());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()),
              path_.string() + ": holds nothing to replay: it was written without the flight recorder");
  }
}

}  // namespace
}  // namespace fovea::flight
