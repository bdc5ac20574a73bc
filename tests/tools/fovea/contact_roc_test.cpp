// SPDX-License-Identifier: Apache-2.0
// The ROC of recordings whose shares are known, and the plan of a contact study.
#include "tools/fovea/contact/roc.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/core/model/kinematics.hpp"
#include "tests/support/panda.hpp"
#include "tools/fovea/atlas/uniform.hpp"
#include "tools/fovea/contact/plan.hpp"

namespace fovea::contact {
namespace {

// A recording of `seconds`; `share_at`: what all detectors see.
template <class Share>
Recording RecordingOf(double seconds, const Share& share_at) {
  Recording recording;
  for (int ms = 0; ms < 1000.0 * seconds; ++ms) {
    const double t_s = 1e-3 * ms;
    const double share = share_at(t_s);
    recording.ticks.push_back({t_s, {share, share, share}, ms % 2 == 0, {}});
  }
  return recording;
}

int AlarmsAt(const QuietRun& run, double threshold) { return run.alarms[0][NearestThreshold(threshold)]; }

TEST(ContactRocTest, ThresholdsAreFound) {
  EXPECT_EQ(NearestThreshold(0.2), 19U);
  EXPECT_DOUBLE_EQ(ThresholdAt(19), 0.2);
  EXPECT_EQ(NearestThreshold(0.0), 0U);
  EXPECT_EQ(NearestThreshold(1e6), kNumThresholds - 1);
}

// Peaks of 0.105 at 1 s and 1.3 s belong together, those at 3 s and 5 s do not.
TEST(ContactRocTest, FalseAlarmsAreCountedOnceUntilTheShareStaysLow) {
  const QuietRun run = JudgeQuiet(RecordingOf(6.0, [](double t_s) {
    for (const double peak : {1.0, 1.3, 3.0, 5.0}) {
      if (std::fabs(t_s - peak) < 0.02) {
        return 0.105;
      }
    }
    return 0.055;
  }));
  EXPECT_NEAR(run.moving_s, 3.0, 1e-9);  // every other tick
  EXPECT_EQ(AlarmsAt(run, 0.11), 0);
  EXPECT_EQ(AlarmsAt(run, 0.10), 3);
  EXPECT_EQ(AlarmsAt(run, 0.06), 3);
  EXPECT_EQ(AlarmsAt(run, 0.05), 1);  // one that never ends
  const FalseAlarms alarms = CountAlarms({run, run}, Detector::kTotal, NearestThreshold(0.1));
  EXPECT_EQ(alarms.alarms, 6);
  EXPECT_NEAR(alarms.PerHour(), 3600.0, 1e-6);
  EXPECT_NEAR(FalseAlarms({0, 3600.0}).PerHourAtMost(), 2.996, 0.03);    // exact: -ln 0.05
  EXPECT_NEAR(FalseAlarms({10, 3600.0}).PerHourAtMost(), 16.962, 0.03);  // exact
}

// A push at 2 s grows linearly to 0.2 within 0.2 s; a share of 0.03 is there before.
TEST(ContactRocTest, DetectionTakesUntilTheShareCrossesTheThreshold) {
  const auto run_of = [](double force) {
    return JudgePushed(RecordingOf(3.0,
                                   [force](double t_s) {
                                     const double push = std::clamp((t_s - 2.0) / 0.2, 0.0, 1.0) * force;
                                     return 0.035 + push;
                                   }),
                       2.0, 2.3);
  };
  const std::vector<PushedRun> runs{run_of(0.2), run_of(0.1), run_of(0.02)};
  const Detection at_5 = Detect(runs, Detector::kTotal, NearestThreshold(0.05));
  EXPECT_EQ(at_5.pushes, 3);
  EXPECT_EQ(at_5.detected, 3);
  EXPECT_NEAR(at_5.median_ms, 31.0, 1.5);  // 0.015 of 0.1 in 200 ms
  EXPECT_NEAR(at_5.most_ms, 151.0, 1.5);
  const Detection at_10 = Detect(runs, Detector::kTotal, NearestThreshold(0.10));
  EXPECT_EQ(at_10.detected, 2);
  EXPECT_NEAR(at_10.Share(), 2.0 / 3.0, 1e-12);
  EXPECT_EQ(Detect(runs, Detector::kTotal, NearestThreshold(0.30)).detected, 0);
  std::vector<PushedRun> stopped = runs;
  stopped[0].other_guard_ms = stopped[2].other_guard_ms = 250.0;
  const Detection with_others = Detect(stopped, Detector::kTotal, NearestThreshold(0.10));
  EXPECT_EQ(with_others.detected, 2);
  EXPECT_EQ(with_others.by_others, 1);
  EXPECT_EQ(with_others.Share(), 1.0);
  // It was above before the push: a false alarm, no detection.
  EXPECT_EQ(Detect(runs, Detector::kTotal, NearestThreshold(0.03)).detected, 0);
}

TEST(ContactPlanTest, TorquesOfAPushDoTheWorkOfItsForce) {
  const model::ArmModel arm = test::PandaConfig().arm;
  const model::VecN ready = test::Ready();
  const std::vector<double> q(ready.data(), ready.data() + ready.size());
  for (const Place place : kPlaces) {
    const Push push{place, model::Vec3(0.6, 0.0, 0.8), 1.5};
    const std::vector<std::string> assignments = AssignmentsOf(push, 10.0, arm, q);
    ASSERT_EQ(assignments.size(), 2U);
    EXPECT_EQ(assignments[1], "faults.push_s=[1.500, 1.800]");
    std::string list = assignments[0].substr(assignments[0].find('[') + 1);
    for (int i = 0; i < 7; ++i) {
      const double torque = std::stod(list);
      list = list.substr(list.find_first_of(",]") + 1);
      const auto at = [&](double step) {
        model::VecN moved = ready;
        moved[i] += step;
        model::ArmPoses poses;
        model::ComputePoses(arm, moved, poses);
        return place == Place::kHand ? poses.X_BE.p : poses.X_BL[3].p;
      };
      constexpr double kStep = 1e-5;
      const double work = 10.0 * push.direction_B.dot(at(kStep) - at(-kStep)) / (2.0 * kStep);
      EXPECT_NEAR(torque, work, 1e-4) << Name(place) << ", joint " << i + 1;
    }
  }
}

TEST(ContactPlanTest, DrawsStayWithinTheirRanges) {
  std::mt19937_64 random(1);
  double least = 1.0;
  double most = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const double drawn = atlas::Uniform(random, 0.0, 1.0);
    least = std::min(least, drawn);
    most = std::max(most, drawn);
    EXPECT_NEAR(DrawPush(random, Place::kHand, Motions().front()).direction_B.norm(), 1.0, 1e-12);
  }
  EXPECT_GE(least, 0.0);
  EXPECT_LT(most, 1.0);
  EXPECT_LT(least, 0.01);
  EXPECT_GT(most, 0.99);
  EXPECT_EQ(WrongBeliefs(random, 0, 2)[0], "truth.arm.link_mass.scale=[1.2000, 1.2000]");
  EXPECT_EQ(WrongBeliefs(random, 1, 2)[0], "truth.arm.link_mass.scale=[0.8000, 0.8000]");
}

}  // namespace
}  // namespace fovea::contact
