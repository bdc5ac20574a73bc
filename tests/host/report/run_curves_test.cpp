// SPDX-License-Identifier: Apache-2.0
// Curves of a report besides the image error: components of e, the features' path, the
// camera's velocity, the path error and the missing frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "firmware/core/link/state.hpp"
#include "firmware/host/recording/flight/messages.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "firmware/host/report/report.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"
#include "tests/support/temp_folder.hpp"

namespace fovea::report {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

class RunCurvesTest : public testing::Test {
 protected:
  static log::Setup Setup(const std::string& target, const std::string& feature) {
    log::Setup setup;
    setup.set_name("curves");
    setup.set_target(target);
    setup.set_feature(feature);
    setup.add_joints()->set_name("hinge");
    setup.set_target_radius(0.04);
    setup.set_f_px(500.0);
    setup.set_c_u_px(320.0);
    setup.set_c_v_px(240.0);
    for (const double value : {0.0, 0.0, 0.4}) {
      setup.add_p_co_c_star(value);
    }
    if (target == "square") {
      for (const double value : {-0.04, -0.04, 0.04, -0.04, 0.04, 0.04, -0.04, 0.04}) {
        setup.add_corners(value);
      }
    }
    return setup;
  }
  // One hinge about B's z axis; flange and camera are 0.5 m from it along x.
  static config::ServoConfig Hinge() {
    config::ServoConfig config;
    config.arm.num_joints = 1;
    config.arm.X_LnE.p = {0.5, 0.0, 0.0};
    return config;
  }
  static hal::TickRecord Record(int tick) {
    hal::TickRecord r;
    r.tick = static_cast<std::uint64_t>(tick);
    r.stamp_ns = tick * hal::kTickPeriodNs;
    r.arm.num_joints = r.command.num_joints = 1;
    r.arm.dq[0] = 2.0;
    r.V_BC_C_cmd = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
    return r;
  }
  [[nodiscard]] RunData Read(const log::Setup& setup, const std::function<void(log::RunLog&)>& write) const {
    {
      log::RunLogConfig config;
      config.path = folder_.path() / "log.mcap";
      config.library = "test";
      config.arm.num_joints = 1;
      log::RunLog log(config);
      log.Add(log::kSetupTopic, 0, setup);
      write(log);
      log.Finish();
    }
    return ReadRun(folder_.path());
  }
  static std::vector<float> Column(const RunData& run, std::size_t which) {
    return run.ticks->rows().columns[RunData::kJointQuantities * run.joints.size() + which];
  }
  // Adds a measurement per frame of `sequences`; a negative number means that no target is found.
  static void AddFrames(log::RunLog& log, const std::vector<int>& sequences) {
    for (const int sequence : sequences) {
      hal::TickRecord r = Record(30 * std::abs(sequence));
      r.has_feature = true;
      r.feature.stamp_ns = r.stamp_ns;
      r.feature.sequence = static_cast<std::uint64_t>(std::abs(sequence));
      r.feature.found = sequence > 0;
      r.feature.dim = 3;
      r.feature.s = {1.0, -2.0, 10.0};
      log.AddTick(r);
    }
  }

  const test::TempFolder folder_;
};

TEST_F(RunCurvesTest, ErrorHasNamedComponentsWithUnits) {
  const auto names = [](const std::string& target, const std::string& feature) {
    std::string text;
    for (const ErrorComponent& component : ErrorComponentsOf(Setup(target, feature))) {
      text += component.name + " [" + component.unit + "], ";
    }
    return text;
  };
  const std::string held = "held turn about x [rad], held turn about y [rad], held turn about z [rad], ";
  EXPECT_EQ(names("sphere", "sphere"), "X / radius [1], Y / radius [1], Z / radius [1], " + held);
  EXPECT_EQ(names("circle", "circle"), "X / Z [1], Y / Z [1], diameter / Z [1], " + held);
  EXPECT_EQ(names("square", "side"),
            "x [1], y [1], angle of the upper side [rad], length of the upper side [1], " + held);
  EXPECT_EQ(names("triangle", "pose").substr(0, 24), "X [m], Y [m], Z [m], tur");
  EXPECT_EQ(ErrorComponentsOf(Setup("square", "corners")).size(), 8U + 3U);
}

TEST_F(RunCurvesTest, ErrorIsShownOnceTheTargetIsKnown) {
  const RunData run = Read(Setup("sphere", "sphere"), [](log::RunLog& log) {
    for (int i = 0; i < 2; ++i) {
      hal::TickRecord r = Record(i);
      r.target_known = i == 1;
      r.dim = 3;
      r.e = {0.5, -0.25, 2.0};
      log.AddTick(r);
    }
  });
  const std::vector<float> second = Column(run, RunData::kError + 1);
  ASSERT_EQ(second.size(), 2U);
  EXPECT_TRUE(std::isnan(second[0]));
  EXPECT_FLOAT_EQ(second[1], -0.25F);
  const json data = json::parse(ToJson(run));
  EXPECT_TRUE(data["ticks"]["e"][2].is_string());
  EXPECT_TRUE(data["ticks"]["e"][3].is_null()) << "e has three entries";
}

TEST_F(RunCurvesTest, CameraVelocityIsThatOfTheModel) {
  const auto with = [&](bool model) {
    return Read(Setup("sphere", "sphere"), [model](log::RunLog& log) {
      if (model) {
        log.Add(log::kConfigurationTopic, 0, flight::ToMessage(Hinge()));
      }
      log.AddTick(Record(0));
    });
  };
  const RunData run = with(true);
  const double measured[] = {0.0, 1.0, 0.0, 0.0, 0.0, 2.0};  // 2 rad/s at 0.5 m
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(Column(run, RunData::kTwistMeas + i)[0], measured[i], 1e-6) << i;
    EXPECT_NEAR(Column(run, RunData::kTwistCmd + i)[0], 0.1 * static_cast<double>(i + 1), 1e-6) << i;
  }
  EXPECT_TRUE(std::isnan(Column(run, RunData::kPathErrorMm)[0])) << "no pose is commanded";
  EXPECT_TRUE(std::isnan(Column(with(false), RunData::kTwistMeas)[0])) << "the log has no arm model";
}

TEST_F(RunCurvesTest, PathErrorIsToTheCommandedPose) {
  const RunData run = Read(Setup("sphere", "sphere"), [](log::RunLog& log) {
    log.Add(log::kConfigurationTopic, 0, flight::ToMessage(Hinge()));
    flight::FlightRecord flown;
    flown.record = Record(0);
    flown.demand.motion.kind = moves::MotionKind::kPoseSetpoint;
    flown.demand.motion.p_BE = {0.5, 0.003, 0.004};
    log.AddTick(flown.record, flight::ReplayDataOf(flown));
  });
  EXPECT_NEAR(Column(run, RunData::kPathErrorMm)[0], 5.0, 1e-5);
}

TEST_F(RunCurvesTest, LostAndEmptyFramesAreCountedAndPlaced) {
  const RunData run = Read(Setup("sphere", "sphere"), [](log::RunLog& log) {
    AddFrames(log, {1, 2, 5, -6, -7, 8, 10});
  });
  EXPECT_EQ(run.frames_taken, 7U);
  ASSERT_EQ(run.lost.size(), 2U);
  EXPECT_DOUBLE_EQ(run.lost[0].from_s, 0.06);
  EXPECT_DOUBLE_EQ(run.lost[0].to_s, 0.15);
  EXPECT_EQ(run.lost[0].frames, 2U);
  EXPECT_EQ(run.lost[1].frames, 1U);
  ASSERT_EQ(run.not_found.size(), 1U);
  EXPECT_DOUBLE_EQ(run.not_found[0].from_s, 0.18);
  EXPECT_DOUBLE_EQ(run.not_found[0].to_s, 0.24);
  EXPECT_EQ(run.not_found[0].frames, 2U);
}

// An operator's change is an event. The values that a slider sends on its way are one event.
TEST_F(RunCurvesTest, OperatorsChangesAreEvents) {
  const RunData run = Read(Setup("sphere", "sphere"), [](log::RunLog& log) {
    for (int i = 0; i < 1000; ++i) {
      hal::TickRecord r = Record(i);
      if (i >= 300 && i <= 400 && i % 20 == 0) {
        r.tuning = {hal::TuningResult::kTaken, 0, 2.0 + 0.01 * (i - 300), 2.2 + 0.01 * (i - 300)};
      } else if (i == 410) {
        r.tuning = {hal::TuningResult::kOutOfRange, 0, 3.2, 40.0};
      } else if (i == 420 || i == 700) {
        r.tuning = {hal::TuningResult::kTaken, 4, 0.6, 0.5};
      }
      log.AddTick(r);
    }
  });
  json events = json::parse(ToJson(run))["tunings"];
  std::vector<int> times_ms;
  for (json& event : events) {
    times_ms.push_back(static_cast<int>(std::lround(1e3 * event["t_s"].get<double>())));
    event.erase("t_s");
  }
  EXPECT_THAT(times_ms, ElementsAre(300, 410, 420, 700));
  const json expected = json::array(
      {{{"taken", true}, {"words", "servo.lambda 2 -> 3.2 1/s, in motion"}},
       {{"taken", false},
        {"words", "servo.lambda 3.2 -> 40 1/s, in motion, refused: the value is outside the key's range"}},
       {{"taken", true}, {"words", "servo.posture_gain 0.6 -> 0.5 1/s, in motion"}},
       {{"taken", true}, {"words", "servo.posture_gain 0.6 -> 0.5 1/s, in motion"}}});
  EXPECT_EQ(events, expected);
}

TEST_F(RunCurvesTest, OperatorsTouchesAreEvents) {
  const RunData run = Read(Setup("sphere", "sphere"), [](log::RunLog& log) {
    log::Touch touch;
    touch.set_stamp_ns(250'000'000);
    touch.set_what("fault");
    touch.set_text("fault camera_outage");
    log.Add(log::kOperatorTopic, touch.stamp_ns(), touch);
    log.AddTick(Record(1000));
  });
  EXPECT_EQ(json::parse(ToJson(run))["touches"],
            json::array({{{"t_s", 0.25}, {"words", "fault camera_outage"}}}));
}

TEST_F(RunCurvesTest, FeaturePathIsInPixels) {
  const RunData run = Read(Setup("sphere", "sphere"), [](log::RunLog& log) { AddFrames(log, {1, -2, 3}); });
  EXPECT_THAT(run.feature_path.goal_px, ElementsAre(320.0F, 240.0F));
  ASSERT_EQ(run.feature_path.px.size(), 6U);
  EXPECT_FLOAT_EQ(run.feature_path.px[0], 370.0F);
  EXPECT_FLOAT_EQ(run.feature_path.px[1], 140.0F);
  EXPECT_TRUE(std::isnan(run.feature_path.px[2])) << "not found";
}

// A detector may name another corner first in each frame; each corner's path must stay continuous.
TEST_F(RunCurvesTest, CornersKeepTheirPaths) {
  const RunData run = Read(Setup("square", "corners"), [](log::RunLog& log) {
    for (std::size_t frame = 0; frame < 3; ++frame) {
      hal::TickRecord r = Record(static_cast<int>(frame));
      r.has_feature = true;
      r.feature.kind = hal::FeatureKind::kSquare;
      r.feature.sequence = frame;
      r.feature.found = true;
      r.feature.dim = 8;
      const std::array<double, 8> corners{-0.1, -0.1, 0.1, -0.1, 0.1, 0.1, -0.1, 0.1};
      for (std::size_t i = 0; i < 8; ++i) {
        r.feature.s[i] = corners[(i + 2 * frame) % 8];
      }
      log.AddTick(r);
    }
  });
  ASSERT_EQ(run.feature_path.px.size(), 24U);
  EXPECT_THAT(run.feature_path.goal_px, ElementsAre(270, 190, 370, 190, 370, 290, 270, 290));
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_FLOAT_EQ(run.feature_path.px[i], run.feature_path.px[i % 8]) << i;
  }
}

TEST_F(RunCurvesTest, LongFeaturePathIsThinned) {
  const RunData run = Read(Setup("sphere", "sphere"), [](log::RunLog& log) {
    std::vector<int> frames(5000);
    std::iota(frames.begin(), frames.end(), 1);
    AddFrames(log, frames);
  });
  EXPECT_LE(run.feature_path.t_s.size(), 2000U);
  EXPECT_GE(run.feature_path.t_s.size(), 1000U);
  EXPECT_EQ(run.feature_path.px.size(), 2 * run.feature_path.t_s.size());
  EXPECT_THAT(run.lost, IsEmpty());
}

TEST_F(RunCurvesTest, CommandAndChangedKeysAreReported) {
  const auto data = [&](bool told) {
    return json::parse(ToJson(Read(Setup("sphere", "sphere"), [told](log::RunLog& log) {
      log.AddMetadata("configuration", {{"servo.lambda", "3"}, {"run.seed", "1"}});
      if (told) {
        log.AddMetadata("defaults", {{"servo.lambda", "2"}});
        log.AddMetadata("run", {{"command", "fovea-sim run ball --set servo.lambda=3"}});
      }
      log.AddTick(Record(0));
    })));
  };
  const json run = data(true);
  EXPECT_EQ(run["command"], "fovea-sim run ball --set servo.lambda=3");
  EXPECT_EQ(run["changed"], json::parse(R"([{"key": "servo.lambda", "value": "3", "default": "2"}])"));
  EXPECT_FALSE(run["info"].contains("defaults servo.lambda"));
  EXPECT_TRUE(data(false)["command"].is_null());
  EXPECT_TRUE(data(false)["changed"].is_null());
}

}  // namespace
}  // namespace fovea::report
