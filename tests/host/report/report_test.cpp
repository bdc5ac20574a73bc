// SPDX-License-Identifier: Apache-2.0
// From a log to a page: the page shows what the log holds, omits the rest, and no log content breaks it.
#include "firmware/host/report/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "fovea/run.pb.h"
#include "fovea/tick.pb.h"
#include "foxglove/scene.pb.h"
#include "tests/support/temp_folder.hpp"

namespace fovea::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class ReportTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "page");
    Page(
        "<title>FOVEA_TITLE</title>\n<!-- FOVEA:STYLE a.css -->\n<!-- FOVEA:DATA -->\n<!-- FOVEA:SCRIPT a.js "
        "-->\n");
    std::ofstream(folder_ / "page" / "a.css") << "p {}\n";
    std::ofstream(folder_ / "page" / "a.js") << "say('</script>');\n";
  }

  void Page(const std::string& text) const { std::ofstream(folder_ / "page" / "report.html") << text; }

  static log::RunLogConfig Config(const fs::path& path) {
    log::RunLogConfig config;
    config.path = path;
    config.library = "test";
    config.arm.num_joints = 2;
    return config;
  }
  static log::Setup Setup(const std::string& name, std::int64_t start_ns = 0) {
    log::Setup setup;
    setup.set_name(name);
    setup.add_joints()->set_name("shoulder");
    setup.add_joints()->set_name("elbow");
    setup.set_start_ns(start_ns);
    setup.set_lambda(2.0);
    setup.set_target_radius(0.04);
    setup.set_f_px(500.0);
    for (const double value : {0.0, 0.0, 0.4}) {
      setup.add_p_co_c_star(value);
    }
    for (int i = 0; i < hal::kNumLimits; ++i) {
      setup.add_limits(hal::Name(static_cast<hal::Limit>(i)));
    }
    return setup;
  }
  static hal::TickRecord Record(int tick, std::int64_t start_ns = 0) {
    hal::TickRecord r;
    r.tick = static_cast<std::uint64_t>(tick);
    r.stamp_ns = start_ns + tick * hal::kTickPeriodNs;
    r.arm.num_joints = r.command.num_joints = 2;
    r.arm.q[1] = 0.001 * tick;
    r.mode = tick < 100 ? hal::Mode::kBoot : hal::Mode::kTrack;
    r.target_known = tick >= 100;
    r.dim = 3;
    r.s = {1.0, 0.0, 10.0};
    r.s_star = {0.0, 0.0, 10.0};
    if (tick >= 200 && tick < 300) {
      r.limits_active = hal::Bit(hal::Limit::kWorkspace);
    }
    if (tick % 50 == 40) {
      r.has_feature = true;
      r.feature.stamp_ns = r.stamp_ns - 40 * hal::kNsPerMs;
      r.feature.found = tick != 240;
      r.feature.dim = r.feature.found ? 3 : 0;
      if (r.feature.found) {
        r.feature.s = {0.5, 0.0, 10.0};
      }
    }
    return r;
  }
  // With ground truth if `truth`.
  void WriteLog(const std::string& name, bool truth, int ticks = 500, std::int64_t start_ns = 0) const {
    log::RunLog log(Config(path_));
    log.Add(log::kSetupTopic, start_ns, Setup(name, start_ns));
    for (int i = 0; i < ticks; ++i) {
      log.AddTick(Record(i, start_ns));
      if (truth) {
        log.AddTruth({start_ns + i * hal::kTickPeriodNs, {}, {}, 100.0 - 0.1 * i, 3.0});
      }
    }
    log.Finish();
  }

  const test::TempFolder temporary_;
  const fs::path folder_ = temporary_.path();
  const fs::path path_ = folder_ / "log.mcap";
};

TEST_F(ReportTest, ShowsTheRunOfALog) {
  WriteLog("swing", true);
  const RunData run = ReadRun(folder_);
  EXPECT_TRUE(run.complete);
  EXPECT_EQ(run.name, "swing");
  EXPECT_DOUBLE_EQ(run.duration_s, 0.499);
  ASSERT_EQ(run.modes.size(), 2U);
  EXPECT_EQ(run.modes[1].mode, "track");
  EXPECT_DOUBLE_EQ(run.modes[1].t_s, 0.1);
  for (const LimitSpans& limit : run.limits_active) {
    EXPECT_EQ(limit.spans_s.size(), limit.name == "workspace" ? 1U : 0U) << limit.name;
    if (limit.name == "workspace") {
      EXPECT_DOUBLE_EQ(limit.spans_s[0][0], 0.2);
      EXPECT_DOUBLE_EQ(limit.spans_s[0][1], 0.3);
    }
  }
  const Envelope::Rows ticks = run.ticks->rows();
  ASSERT_EQ(ticks.t_s.size(), 500U);
  const std::size_t at = RunData::kJointQuantities * run.joints.size();
  EXPECT_FLOAT_EQ(ticks.columns[1][250], 0.25F);
  EXPECT_FLOAT_EQ(ticks.columns[at + RunData::kErrorPx][250], 75.0F) << "the truth of the same tick";
  EXPECT_TRUE(std::isnan(ticks.columns[at + RunData::kPredictedPx][50])) << "the target is not known yet";
  EXPECT_FLOAT_EQ(ticks.columns[at + RunData::kPredictedPx][250], 50.0F);
  const Envelope::Rows measured = run.measured.rows();
  ASSERT_EQ(measured.t_s.size(), 10U);
  EXPECT_FLOAT_EQ(measured.columns[RunData::kMeasuredPx][0], 25.0F)
      << "before the servo knows the target too";
  EXPECT_TRUE(std::isnan(measured.columns[RunData::kMeasuredPx][4])) << "not found";
  EXPECT_FLOAT_EQ(measured.columns[RunData::kAgeMs][0], 40.0F);
}

// Errors of a flat target are in the same pixels as the truth, for every form of s.
TEST_F(ReportTest, ShowsFlatTargetErrorsInPixels) {
  const double c = std::cos(0.1);
  const double s = std::sin(0.1);
  const auto error_of = [&](const std::string& target, const std::string& form, const hal::TickRecord& r) {
    log::RunLog log(Config(path_));
    log::Setup setup = Setup("flat");
    setup.set_target(target);
    setup.set_feature(form);
    if (target == "square") {
      for (const double value : {-0.04, -0.04, 0.04, -0.04, 0.04, 0.04, -0.04, 0.04}) {
        setup.add_corners(value);
      }
    }
    log.Add(log::kSetupTopic, 0, setup);
    log.AddTick(r);
    log.Finish();
    const RunData run = ReadRun(folder_);
    const std::size_t at = RunData::kJointQuantities * run.joints.size() + RunData::kPredictedPx;
    return std::pair(run.ticks->rows().columns[at][0], run.measured.rows().columns[RunData::kMeasuredPx][0]);
  };
  hal::TickRecord r = Record(140);
  // A disc, off by 0.01 of the focal length.
  r.feature.kind = hal::FeatureKind::kCircle;
  r.s = r.feature.s = {0.01, 0.0, 0.2};
  r.s_star = {0.0, 0.0, 0.2};
  const auto [disc_predicted, disc_measured] = error_of("circle", "circle", r);
  EXPECT_FLOAT_EQ(disc_predicted, 5.0F);
  EXPECT_FLOAT_EQ(disc_measured, 5.0F);
  // A square at 0.4 m, turned by 90 degrees (invisible by symmetry) plus 0.1 rad: each corner moves by 2
  // sin(0.05) times its distance from the centre.
  const double moved_px = 500.0 * 2.0 * std::sin(0.05) * 0.04 * std::sqrt(2.0) / 0.4;
  r.feature.kind = hal::FeatureKind::kSquare;
  r.feature.num_poses = 1;
  r.feature.poses[0].p_CO_C = {0.0, 0.0, 0.4};
  r.feature.poses[0].q_CO = {std::cos(0.5 * (0.1 + M_PI / 2)), 0.0, 0.0, std::sin(0.5 * (0.1 + M_PI / 2))};
  r.dim = 8;
  r.s_star = {-0.1, -0.1, 0.1, -0.1, 0.1, 0.1, -0.1, 0.1};
  for (std::size_t i = 0; i < 8; i += 2) {
    r.s[i] = c * r.s_star[i] - s * r.s_star[i + 1];
    r.s[i + 1] = s * r.s_star[i] + c * r.s_star[i + 1];
  }
  const auto [square_predicted, square_measured] = error_of("square", "corners", r);
  EXPECT_NEAR(square_predicted, moved_px, 1e-4);
  EXPECT_NEAR(square_measured, moved_px, 1e-4);
  // The same as a pose feature: phi is the rotation from the present to the desired orientation.
  r.dim = 6;
  r.s = {0.0, 0.0, 0.4, 0.0, 0.0, -0.1};
  r.s_star = {0.0, 0.0, 0.4, 0.0, 0.0, 0.0};
  EXPECT_NEAR(error_of("square", "pose", r).first, moved_px, 1e-4);
}

// The 3-D view shows the target's orientation, from the ground truth if the log has it.
TEST_F(ReportTest, TargetOrientationReachesTheScene) {
  for (const bool truth : {false, true}) {
    log::RunLog log(Config(path_));
    log.Add(log::kSetupTopic, 0, Setup("turn"));
    for (int i = 0; i < 60; ++i) {
      hal::TickRecord r = Record(i + 200);
      r.q_BO = {0.6, 0.0, 0.8, 0.0};
      log.AddTick(r);
      if (truth) {
        log.AddTruth({r.stamp_ns, {}, {}, 1.0, 1.0, {0.0, 0.6, 0.0, 0.8}});
      }
    }
    log.Finish();
    const SceneMotion& motion = ReadRun(folder_).motion;
    ASSERT_GE(motion.target_turn.size(), 8U);
    EXPECT_EQ(motion.target_turn.size(), 4 * motion.t_s.size());
    const std::vector<float> first(motion.target_turn.begin(), motion.target_turn.begin() + 4);
    EXPECT_EQ(first, truth ? std::vector<float>({0.0F, 0.6F, 0.0F, 0.8F})
                           : std::vector<float>({0.6F, 0.0F, 0.8F, 0.0F}));
  }
}

// A robot's clock may start at any time, also after centuries.
TEST_F(ReportTest, CountsTimeFromTheRunsStart) {
  WriteLog("late", true, 500, std::int64_t{1} << 62);
  const RunData run = ReadRun(folder_);
  EXPECT_DOUBLE_EQ(run.duration_s, 0.499);
  ASSERT_EQ(run.modes.size(), 2U);
  EXPECT_DOUBLE_EQ(run.modes[1].t_s, 0.1);
  const Envelope::Rows ticks = run.ticks->rows();
  ASSERT_EQ(ticks.t_s.size(), 500U);
  EXPECT_FLOAT_EQ(static_cast<float>(ticks.t_s[250]), 0.25F);
  const Envelope::Rows measured = run.measured.rows();
  ASSERT_EQ(measured.t_s.size(), 10U);
  EXPECT_FLOAT_EQ(static_cast<float>(measured.t_s[0]), 0.0F);
}

TEST_F(ReportTest, OmitsWhatTheLogDoesNotHold) {
  WriteLog("robot", false);
  const json data = json::parse(ToJson(ReadRun(path_)));
  EXPECT_TRUE(data["ticks"]["error_px"].is_null());
  EXPECT_TRUE(data["ticks"]["predicted_px"].is_string());
  for (const char* key : {"summary", "tick_times", "frames", "video", "scene", "incomplete"}) {
    EXPECT_TRUE(data[key].is_null()) << key;
  }
}

TEST_F(ReportTest, ShowsATruncatedLogAsIncomplete) {
  WriteLog("cut", true, 8000);
  fs::resize_file(path_, fs::file_size(path_) * 6 / 10);
  const RunData run = ReadRun(path_);
  EXPECT_GT(run.duration_s, 1.0);
  EXPECT_LT(run.duration_s, 7.0);
  EXPECT_FALSE(run.complete);
  EXPECT_NE(run.why_incomplete.find("cut off"), std::string::npos) << run.why_incomplete;
  EXPECT_FALSE(json::parse(ToJson(run))["incomplete"].is_null());
}

TEST_F(ReportTest, RefusesALogWithoutARun) {
  EXPECT_THROW(ReadRun(folder_ / "nothing.mcap"), std::runtime_error);
  std::ofstream(path_) << "no log";
  EXPECT_THROW(ReadRun(path_), std::runtime_error);
  {
    log::RunLog log(Config(path_));
    log.Finish();
  }
  try {
    ReadRun(path_);
    ADD_FAILURE() << "a log without a set-up was accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/setup"), std::string::npos) << error.what();
  }
}

// A log from an untrusted source may contradict itself.
TEST_F(ReportTest, InconsistentLogIsRefusedOrShownInPart) {
  const auto said = [this](const std::function<void(log::RunLog&)>& write) -> std::string {
    {
      log::RunLog log(Config(path_));
      write(log);
      log.Finish();
    }
    try {
      const std::string text = ToJson(ReadRun(folder_));
      EXPECT_TRUE(json::accept(text));
      return text;
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  const auto tick = [](log::RunLog& log, const std::function<void(log::Tick&)>& change) {
    log::Tick message;
    change(message);
    log.Add(log::kTickTopic, 0, message);
  };
  EXPECT_THAT(said([](log::RunLog& log) {
                log.Add(log::kSetupTopic, 0, Setup("one"));
                log.Add(log::kSetupTopic, 0, Setup("two"));
              }),
              HasSubstr("a second set-up"));
  EXPECT_THAT(said([](log::RunLog& log) {
                log::Setup setup = Setup("many");
                for (int i = 0; i < 100; ++i) {
                  setup.add_limits("more");
                }
                log.Add(log::kSetupTopic, 0, setup);
              }),
              HasSubstr("at most 8 and 32"));
  // Unknown enumerators, and times out of range.
  EXPECT_THAT(said([&](log::RunLog& log) {
                log.Add(log::kSetupTopic, 0, Setup("odd", INT64_MIN));
                tick(log, [](log::Tick& t) {
                  t.set_fault(static_cast<log::FaultCause>(100'000));
                  t.set_mode(static_cast<log::Mode>(77));
                  t.set_stamp_ns(INT64_MAX);
                  t.set_limits_active(UINT32_MAX);
                });
              }),
              HasSubstr("\"name\":\"unknown\""));
  // Triangle indices without a point, and links without poses.
  EXPECT_THAT(said([](log::RunLog& log) {
                log.Add(log::kSetupTopic, 0, Setup("scene"));
                foxglove::SceneUpdate scene;
                foxglove::SceneEntity* entity = scene.add_entities();
                entity->set_frame_id("link");
                foxglove::TriangleListPrimitive* triangles = entity->add_triangles();
                triangles->add_points()->set_x(1.0);
                for (const std::uint32_t index : {0U, 1U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
                  triangles->add_indices(index);
                }
                foxglove::FrameTransforms transforms;
                transforms.add_transforms()->set_child_frame_id("link");
                for (int i = 0; i < 900; ++i) {  // enough to be thinned, without a link
                  log.Add(log::kTransformTopic, i, transforms);
                }
                log.Add(log::kSceneTopic, 0, scene);
                log.Add(log::kTransformTopic, 901, transforms);
              }),
              HasSubstr("\"scene\":null"));
  // A summary nested deeper than the writer allows.
  EXPECT_THAT(said([](log::RunLog& log) {
                log.Add(log::kSetupTopic, 0, Setup("deep"));
                log.AddAttachment("summary.json", "application/json",
                                  std::string(200'000, '[') + std::string(200'000, ']'));
              }),
              HasSubstr("\"name\":\"deep\""));
}

// A name may hold any text; so may the page's own scripts.
TEST_F(ReportTest, NamesFromALogAreEscapedInThePage) {
  WriteLog("</script><!--<b>&", true);
  const std::string page = ReportPage(folder_ / "page").Make({ReadRun(path_), ReadRun(path_)});
  const auto count = [&page](const std::string& text) {
    std::size_t found = 0;
    for (std::size_t at = page.find(text); at != std::string::npos; at = page.find(text, at + 1)) {
      ++found;
    }
    return found;
  };
  EXPECT_EQ(count("</script"), 3U) << "one for each of two runs, one for the page's script";
  EXPECT_EQ(count("<!--"), 0U);
  EXPECT_EQ(count("<style>"), 1U);
  EXPECT_EQ(count("<title>&lt;/script>&lt;!--&lt;b>&amp; and"), 1U);
  const auto begin = page.find("class=\"fovea-run\">") + 18;
  const json data = json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  EXPECT_EQ(data["name"], "</script><!--<b>&");
}

TEST_F(ReportTest, MissingPagePartIsNamed) {
  Page("<!-- FOVEA:SCRIPT missing.js -->\n");
  try {
    ReportPage page(folder_ / "page");
    ADD_FAILURE() << "a page without its script was accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("missing.js"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace fovea::report
