// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/beliefs/run_watch.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <utility>

#include "firmware/host/beliefs/eye_estimate.hpp"
#include "firmware/host/beliefs/findings_json.hpp"
#include "tests/host/beliefs/synthetic_run.hpp"

namespace fovea::beliefs {
namespace {

using Change = std::function<void(hal::TickRecord&)>;

// `late_s`: what the servo itself estimates, with 2 ms of standard deviation; none: it knows no target.
// `change`: of each record, at last.
Findings Watch(const test::SyntheticTruth& truth, const model::Pose& X_BO_change_per_s,
               std::optional<double> late_s = std::nullopt, EyeEstimate* eye = nullptr,
               const Change& change = {}) {
  const config::ServoConfig config = test::PandaConfig();
  model::Load load;
  RunWatch watch(config, {40.0, load});
  test::MakeRun(config, test::LookAround(), {model::Mat3::Identity(), test::BallPlace()}, truth, {}, 7.0, 1,
                [&](const hal::TickRecord& record) {
                  hal::TickRecord moved = record;
                  for (std::size_t i = 0; i < 3; ++i) {
                    moved.p_BO[i] =
                        X_BO_change_per_s.p[static_cast<Eigen::Index>(i)] * hal::ToSeconds(record.stamp_ns);
                    moved.feature.s[i] += X_BO_change_per_s.p[static_cast<Eigen::Index>(i)] *
                                          hal::ToSeconds(record.stamp_ns) / config.feature.radius;
                  }
                  moved.target_known = late_s.has_value();
                  moved.stamp_late_s = late_s.value_or(0.0);
                  moved.stamp_late_sigma_s = 0.002;
                  if (change) {
                    change(moved);
                  }
                  watch.Add(moved);
                });
  if (eye != nullptr) {
    *eye = watch.Eye();
  }
  return watch.Finish();
}

TEST(RunWatchTest, SaysWhatIsWrongAndWhatToSet) {
  test::SyntheticTruth truth;
  truth.late = 0.018;
  truth.turn.x() = 0.03;
  const Findings findings = Watch(truth, {});
  ASSERT_EQ(findings.verdict.size(), 2U);
  fmt::print("{}\n{}\n", findings.verdict[0], findings.verdict[1]);
  EXPECT_THAT(findings.verdict[0], testing::StartsWith("latency is 5"));
  EXPECT_THAT(findings.verdict[0], testing::HasSubstr(" ms, configured 40: set camera.latency_ms = 5"));
  EXPECT_THAT(findings.verdict[1],
              testing::StartsWith("mount turn about the camera\'s x axis is off by 1.7"));
  EXPECT_THAT(findings.verdict[1], testing::EndsWith("deg (camera.mount_rpy_deg)"));
}

// The synthetic detector is better than a real one: its sigmas would be smaller than errors of one that
// repeat.
TEST(RunWatchTest, SaysNothingOfARightBelief) {
  EyeEstimate eye;
  const Findings findings = Watch({}, {}, std::nullopt, &eye);
  EXPECT_TRUE(findings.verdict.empty());
  EXPECT_EQ(findings.beliefs.at(0).name, "latency");
  EXPECT_GT(findings.beliefs[0].sigma, 0.02);
  EXPECT_LT(findings.beliefs[0].sigma, 0.05);
  // Beyond what the views themselves tell.
  for (const auto& [begin, shared] :
       {std::pair{"latency", 0.006}, std::pair{"mount shift", 0.0002}, std::pair{"mount turn", 0.0175},
        std::pair{"focal length", 0.034}, std::pair{"target size", 0.02}, std::pair{"encoder zero", 0.045}}) {
    int found = 0;
    for (std::size_t i = 0; i < eye.beliefs.size(); ++i) {
      ASSERT_EQ(findings.beliefs.at(i).name, eye.beliefs[i].name);
      if (eye.beliefs[i].name.starts_with(begin)) {
        ++found;
        EXPECT_DOUBLE_EQ(findings.beliefs[i].sigma, std::hypot(eye.beliefs[i].sigma, shared)) << begin;
      }
    }
    EXPECT_GT(found, 0) << begin;
  }
}

// The eye knows nothing then, although the numbers would be precise.
TEST(RunWatchTest, ATargetThatMovesTellsNothing) {
  const Findings findings = Watch({}, {model::Mat3::Identity(), model::Vec3(0.05, 0.02, 0.0)});
  fmt::print("misfit {:.1f}\n", findings.misfit);
  const auto latency = std::find_if(findings.beliefs.begin(), findings.beliefs.end(),
                                    [](const Belief& belief) { return belief.name == "latency"; });
  ASSERT_NE(latency, findings.beliefs.end());
  EXPECT_FALSE(latency->IsKnown());
}

const Belief& LatencyOf(const Findings& findings) {
  return *std::find_if(findings.beliefs.begin(), findings.beliefs.end(),
                       [](const Belief& belief) { return belief.name == "latency"; });
}

// Of a target that moves the servo's own filter tells the latency; of one at rest the views do, and better.
TEST(RunWatchTest, TakesTheServosLatencyOfATargetThatMoves) {
  const model::Pose moves{model::Mat3::Identity(), model::Vec3(0.05, 0.02, 0.0)};
  const Findings moved = Watch({}, moves, 0.018);
  EXPECT_DOUBLE_EQ(LatencyOf(moved).difference, 18.0);
  EXPECT_DOUBLE_EQ(LatencyOf(moved).sigma, 2.0);
  ASSERT_FALSE(moved.verdict.empty());
  EXPECT_EQ(moved.verdict[0], "latency is 58 +- 2 ms, configured 40: set camera.latency_ms = 58.0");
  const Findings bound = Watch({}, moves, 0.03);
  EXPECT_DOUBLE_EQ(LatencyOf(bound).sigma, 5.0) << "at the end of what the servo believes";
  const Findings still = Watch({}, {}, 0.018);
  EXPECT_LT(std::fabs(LatencyOf(still).difference), 1.0);
  EXPECT_LT(LatencyOf(still).sigma, 0.1);
}

// A filter whose model is wrong, as with a mount that is turned, wanders by more than it says.
TEST(RunWatchTest, ALatencyThatStillWandersIsNotKnown) {
  const model::Pose moves{model::Mat3::Identity(), model::Vec3(0.05, 0.02, 0.0)};
  const Findings findings = Watch({}, moves, 0.018, nullptr, [](hal::TickRecord& record) {
    record.stamp_late_s = 0.018 + 0.02 * std::sin(2.0 * hal::ToSeconds(record.stamp_ns));
  });
  fmt::print("sigma {:.1f} ms\n", LatencyOf(findings).sigma);
  EXPECT_GT(LatencyOf(findings).sigma, 5.0);
  EXPECT_TRUE(findings.verdict.empty());
}

TEST(RunWatchTest, ATargetKnownForLessThanASecondTellsNoLatency) {
  const model::Pose moves{model::Mat3::Identity(), model::Vec3(0.05, 0.02, 0.0)};
  const auto known_for = [&](double seconds) {
    return LatencyOf(Watch({}, moves, 0.018, nullptr,
                           [&](hal::TickRecord& record) {
                             record.target_known = std::fmod(hal::ToSeconds(record.stamp_ns), 1.5) < seconds;
                           }))
        .IsKnown();
  };
  EXPECT_FALSE(known_for(0.9));
  EXPECT_TRUE(known_for(1.2));
}

TEST(RunWatchTest, AnEyeThatTheServoDoubtsTellsNoLatency) {
  const model::Pose moves{model::Mat3::Identity(), model::Vec3(0.05, 0.02, 0.0)};
  const auto held_for = [&](hal::HoldReason reason) {
    return LatencyOf(Watch({}, moves, 0.018, nullptr,
                           [&](hal::TickRecord& record) {
                             if (hal::ToSeconds(record.stamp_ns) > 6.5) {
                               record.mode = hal::Mode::kHold;
                               record.hold_reason = reason;
                             }
                           }))
        .IsKnown();
  };
  EXPECT_TRUE(held_for(hal::HoldReason::kTargetLost));
  EXPECT_FALSE(held_for(hal::HoldReason::kEyeDoubted));
}

// Stamps that jitter make views of a still target disagree. The servo's filter does not know of it either.
TEST(RunWatchTest, ViewsOfAStillTargetThatDoNotFitTellNothing) {
  std::mt19937_64 engine(5);
  std::normal_distribution<double> jitter(0.0, 0.05);
  const Findings findings = Watch({}, {}, 0.018, nullptr, [&](hal::TickRecord& record) {
    record.feature.s[0] += jitter(engine);
    record.feature.s[1] += jitter(engine);
  });
  fmt::print("{} views, misfit {:.1f}\n", findings.views, findings.misfit);
  EXPECT_GT(findings.views, 20);
  EXPECT_GT(findings.misfit, Findings::kMostMisfit);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_FALSE(findings.beliefs.at(i).IsKnown()) << findings.beliefs[i].name;
  }
}

TEST(FindingsJsonTest, UnknownNumbersAreNull) {
  Findings findings;
  findings.views = 3;
  findings.beliefs.push_back({"latency", "camera.latency_ms", "ms", 18.0, 0.4, 5.0, 1.0});
  findings.beliefs.push_back({"focal length", "camera.f_u_px", "%", 1.0, 2.0, 1.0, 0.2});
  const nlohmann::ordered_json json = ToJson(findings);
  EXPECT_EQ(json["views"], 3);
  EXPECT_EQ(json["values"]["latency"]["difference"], 18.0);
  EXPECT_TRUE(json["values"]["latency"]["known"]);
  EXPECT_FALSE(json["values"]["focal length"]["known"]);
  EXPECT_TRUE(json["values"]["focal length"]["difference"].is_null());
  EXPECT_TRUE(json["values"]["focal length"]["sigma"].is_null());
}

}  // namespace
}  // namespace fovea::beliefs
