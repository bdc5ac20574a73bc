// SPDX-License-Identifier: Apache-2.0
// Starts from which `fovea atlas` once did not reach the goal: one for each cause, all fixed.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

using Assignments = std::vector<std::string>;

const Assignments kTable{"safety.planes=[0,0,1,0.03]"};  // as `fovea atlas` sets it

Assignments operator+(Assignments a, const Assignments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

void ExpectReached(const sim::Summary& s) {
  PrintResidual(s);
  EXPECT_TRUE(s.converged) << s.verdict;
  EXPECT_LE(s.final_error_px_rms.value_or(1e9), 0.5);
  EXPECT_LE(s.final_error_mm.value_or(1e9), 1.0);
  EXPECT_LE(s.final_error_deg.value_or(0.0), 0.3);
  EXPECT_EQ(s.limit_violations, 0U);
}

// When each joint changed speed at its own pace, the target left the picture.
class WideTurn : public testing::TestWithParam<Assignments> {};

TEST_P(WideTurn, KeepsTheTargetInView) { ExpectReached(RunShipped("triangle", kTable + GetParam())); }

INSTANTIATE_TEST_SUITE_P(
    Starts, WideTurn,
    testing::Values(Assignments{"arm.q_start=[2.3043,-1.0367,2.1821,-2.9143,-0.5586,1.0495,2.2187]",
                                "target.position=[-0.1701,0.2993,0.8392]",
                                "target.rpy_deg=[62.15,-16.28,141.97]", "run.seed=1572773331"},
                    Assignments{"arm.q_start=[-0.4511,-1.1148,-1.4469,-2.3688,0.9815,2.1172,-2.3358]",
                                "target.position=[0.2598,-0.575,0.5328]",
                                "target.rpy_deg=[85.14,33.95,69.31]", "run.seed=1906482257"}));

// Starts with a way that a plan or the law before it missed.
struct Hard {
  const char* name;
  const char* target;
  Assignments start;
  double settled_s;  // at most
};
void PrintTo(const Hard& hard, std::ostream* out) { *out << hard.name; }

class HardStart : public testing::TestWithParam<Hard> {};

TEST_P(HardStart, IsReached) {
  const sim::Summary s = RunShipped(GetParam().target, kTable + GetParam().start);
  ExpectReached(s);
  EXPECT_LE(s.settle_time_s.value_or(HUGE_VAL), GetParam().settled_s);
}

INSTANTIATE_TEST_SUITE_P(
    Runs, HardStart,
    testing::Values(
        // The plan crawled along the disc's largest tilt.
        Hard{"DiscAtItsLargestTilt",
             "circle",
             {"arm.q_start=[-2.6007,-1.2893,-0.5316,-2.6238,-2.1265,0.3195,-1.0821]",
              "target.position=[0.3711,0.8822,0.6342]", "target.rpy_deg=[171.57,41.66,-175.75]",
              "run.seed=1704091392"},
             3.5},
        // The quickest way passes nearer to the lines of sight than a plan likes.
        Hard{"NarrowPassage",
             "triangle",
             {"arm.q_start=[-2.7305,-0.3515,1.3171,-2.5596,-2.244,1.3497,1.3053]",
              "target.position=[-0.1183,-0.6705,0.6923]", "target.rpy_deg=[-6.6,29.86,167.82]",
              "run.seed=1119774359", "run.duration_s=12"},
             7.5},
        // The picture of the arm that settles seemed stuck, because the lateness found meanwhile had changed.
        Hard{"SettlingBeforeAWall",
             "triangle",
             {"arm.q_start=[0.9378,0.8422,-0.6548,-1.6982,-1.7561,0.9161,-0.7095]",
              "target.position=[0.2348,-0.294,1.1191]", "target.rpy_deg=[-33.29,-17.39,-156.31]",
              "run.seed=1951717603"},
             6.0},
        // The arm's stop before a plan, from a fast joint of a slow law, lost the target.
        Hard{"FastJointOfASlowLaw",
             "triangle",
             {"arm.q_start=[0.5554,0.2702,-1.4411,-2.7501,-1.0992,1.7317,-1.6703]",
              "target.position=[-0.8643,-0.1878,0.3567]", "target.rpy_deg=[79.97,-36.57,-30.4]",
              "run.seed=1475456643"},
             6.5},
        // The camera only turns and goes back: nothing told the disc's two poses apart, 2.7 mm from each
        // other.
        Hard{"DiscSeenFromOneSide",
             "circle",
             {"arm.q_start=[1.892,-1.6401,1.1834,-0.8585,0.5559,0.3865,2.2807]",
              "target.position=[-0.2341,-0.2192,0.2838]", "target.rpy_deg=[-115.04,25.75,28.17]",
              "run.seed=113750806"},
             3.0},
        Hard{"DiscSeenFromOneSideAtAHeight",
             "circle",
             {"arm.q_start=[1.4922,-0.0064,-1.9224,-2.635,-1.9101,0.3877,-0.6231]",
              "target.position=[-0.0017,-0.2446,0.8639]", "target.rpy_deg=[-20.41,62.41,143.57]",
              "run.seed=901707606"},
             3.0},
        // The eye was trusted late: the plan's pace rose faster than the joints could, and the arm left its
        // path.
        Hard{"TrustInAFastMotion",
             "square",
             {"arm.q_start=[-1.6029,-1.0666,-0.6255,-2.544,-1.6718,3.3218,-1.1766]",
              "target.position=[-0.298,-0.8056,0.583]", "target.rpy_deg=[23.22,49.77,-73.14]",
              "run.seed=1766776498"},
             4.0},
        // All ways show the square from very steep sides.
        Hard{"SteepViews",
             "square",
             {"arm.q_start=[1.8184,1.3888,-1.2526,-0.3857,-2.417,0.0932,-1.7839]",
              "target.position=[-0.2498,-0.0315,0.7559]", "target.rpy_deg=[61.49,-46.07,9.32]",
              "run.seed=1063027370", "run.duration_s=16"},
             14.0}),
    [](const auto& hard) { return std::string(hard.param.name); });

// Without plans: the pull towards the posture turned the disc edge-on, where the detector cannot find it.
TEST(RandomStarts, PosturePullDoesNotTurnTheDiscEdgeOn) {
  const Assignments start =
      kTable + Assignments{"arm.q_start=[-2.7705,-1.3044,1.8399,-2.7133,-0.6047,1.2502,0.726]",
                           "target.position=[-0.197,-0.1179,0.5561]",
                           "target.rpy_deg=[-2.85,-10.34,29.46]",
                           "run.seed=458361091",
                           "servo.plans=false",
                           "servo.posture_gain=1.2",
                           "servo.free_speed=0.6"};
  ExpectReached(RunShipped("circle", start));
  const sim::Summary turned =
      RunShipped("circle", start + Assignments{"safety.disc_tilt_max=1.5707963267948966"});
  EXPECT_FALSE(turned.converged) << "this start does not need the limit";
}

// Along the joint limits the law comes ever nearer and never arrives.
TEST(RandomStarts, LawCreepingAlongJointLimitsSwitchesToJointMotion) {
  ExpectReached(RunShipped(
      "square", kTable + Assignments{"arm.q_start=[0.4502,0.1945,0.1255,-2.8132,1.7986,0.8771,-1.3372]",
                                     "target.position=[-0.158,0.6334,0.93]",
                                     "target.rpy_deg=[36.39,21.04,-174.32]", "run.seed=998841373"}));
}

// No straight joint path keeps the target in the picture and unhidden by the arm.
TEST(RandomStarts, GoalIsReachedThroughAnotherPosture) {
  ExpectReached(RunShipped(
      "triangle", kTable + Assignments{"arm.q_start=[-2.5214,-1.0664,0.1162,-2.5597,-0.4828,0.3145,-0.6362]",
                                       "target.position=[0.3949,0.6875,0.3594]",
                                       "target.rpy_deg=[-118.72,46.78,-47.34]", "run.seed=2049788278"}));
}

// Once the disc has long been at its goal, the pull towards the posture lowers the elbow onto the table.
TEST(RandomStarts, ElbowStaysOffTheTable) {
  const Assignments start{"arm.q_start=[2.1031,1.5001,-1.0773,-2.8139,-2.1353,0.5257,-0.5922]",
                          "target.position=[0.2627,0.5386,0.4850]", "target.rpy_deg=[-62.40,12.60,15.59]",
                          "run.seed=1374156519"};
  const sim::Summary s = RunShipped("circle", kTable + start);
  ExpectReached(s);
  EXPECT_EQ(s.contact_ticks, 0U);
  EXPECT_FALSE(RunShipped("circle", Assignments{"safety.planes=[]"} + start).converged)
      << "this start does not need the plane";
}

// The visual law of the disc gets stuck at the workspace boundary and at a joint's end.
TEST(RandomStarts, DiscStuckAtTheWorkspaceEdgeIsReachedByJointMotion) {
  ExpectReached(RunShipped(
      "circle", kTable + Assignments{"arm.q_start=[-2.3956,1.2114,-1.8414,-0.1733,-0.1007,0.1571,-0.4550]",
                                     "target.position=[-0.1555,0.1822,0.3767]",
                                     "target.rpy_deg=[109.18,-16.42,139.00]", "run.seed=211989553"}));
}

// The pull towards the posture took the arm to a singular posture, where the limit made it shake.
TEST(RandomStarts, PosturePullDoesNotLeadIntoASingularity) {
  ExpectReached(RunShipped(
      "square", kTable + Assignments{"arm.q_start=[-0.7687,0.4223,2.0693,-2.6271,0.3013,3.1874,-0.4641]",
                                     "target.position=[0.0267,0.8067,0.0744]",
                                     "target.rpy_deg=[-155.47,-14.63,44.89]", "run.seed=1220879638"}));
}

}  // namespace
}  // namespace fovea::test
