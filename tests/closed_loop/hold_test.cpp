// SPDX-License-Identifier: Apache-2.0
// A target that is unreachable, absent or lost: the arm stands still in Hold and reports the reason.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

using testing::HasSubstr;

// Keeps the largest joint speed of a run, and of its last half second [rad/s].
class RestWatch {
 public:
  sim::RunOptions Options(double duration_s) {
    sim::RunOptions options;
    options.observer.on_truth = [this, duration_s](const sim::Truth& truth) {
      const double speed = truth.dq.cwiseAbs().maxCoeff();
      fastest_ = std::max(fastest_, speed);
      if (static_cast<double>(truth.stamp_ns) * 1e-9 > duration_s - 0.5) {
        at_the_end_ = std::max(at_the_end_, speed);
      }
    };
    return options;
  }
  [[nodiscard]] double fastest() const { return fastest_; }
  [[nodiscard]] double at_the_end() const { return at_the_end_; }

 private:
  double fastest_ = 0.0;
  double at_the_end_ = 0.0;
};

constexpr double kAtRest = 0.005;  // [rad/s]; above what encoder noise causes

void ExpectHeldAsUnreachable(const sim::Summary& s, const RestWatch& watch) {
  PrintResidual(s);
  EXPECT_FALSE(s.converged);
  EXPECT_EQ(LastMode(s), "hold");
  EXPECT_EQ(LastReason(s), "goal_unreachable");
  EXPECT_THAT(s.verdict, HasSubstr("limits keep the arm from the goal"));
  EXPECT_LT(watch.at_the_end(), kAtRest);
  ExpectSound(s);
}

TEST(Hold, UnreachableBallEndsInHoldWithAReason) {
  RestWatch watch;
  // The ball is visible from the start. To be 1.15 m away from it the arm would have to leave its small
  // workspace or, turned round, stand behind the wall.
  const sim::Summary s = RunShipped("ball",
                                    {"servo.goal=[0, 0, 1.15]", "safety.workspace_radius=0.79",
                                     "safety.planes=[0, 0, 1, 0.01, 1, 0, 0, -0.25]", "run.duration_s=10"},
                                    watch.Options(10.0));
  ExpectHeldAsUnreachable(s, watch);
}

TEST(Hold, BallBeyondTheWorkspaceEndsInHoldAtTheBarrier) {
  RestWatch watch;
  const sim::Summary s = RunShipped(
      "ball", {"target.position=[1.4, 0.1, 0.04]", "arm.q_start=[0.1, -0.2, 0, -1.9, 0, 2.2, 0.785]"},
      watch.Options(8.0));
  ExpectHeldAsUnreachable(s, watch);
  EXPECT_GT(s.limits.at("workspace"), 0.98) << "the barrier did not stop the arm";
  EXPECT_LE(s.limits.at("workspace"), 1.0);
}

// The end of a joint's range keeps the hand one degree from its goal. The picture is then 0.2 px off.
TEST(Hold, GoalJustPastAJointsEndEndsInHold) {
  RestWatch watch;
  const sim::Summary s =
      RunShipped("square",
                 {"arm.q_start=[1.8719, 1.6592, -1.9479, -1.5433, -0.5901, 0.6927, -1.0301]",
                  "target.position=[-0.0043, -0.0872, 0.5054]", "target.rpy_deg=[-80.38, -61.6, 171.07]",
                  "safety.planes=[0, 0, 1, 0.03]", "run.duration_s=18"},
                 watch.Options(18.0));
  ExpectHeldAsUnreachable(s, watch);
}

// Limits stop the law, and nobody plans. When the planner answers again, the servo tries again.
TEST(Hold, GoalThatNobodyPlannedForIsTriedAgainWhenThePlannerIsBack) {
  const sim::Summary s =
      RunShipped("square", {"arm.q_start=[-2.6566,1.6366,2.3785,-2.0177,1.5886,0.249,-0.3674]",
                            "target.position=[-0.7791,0.1669,0.2131]",
                            "target.rpy_deg=[-133.78,-69.58,139.85]", "safety.planes=[0,0,1,0.03]",
                            "run.seed=1167555662", "run.duration_s=14", "faults.planner_loss_s=[0,6]"});
  PrintResidual(s);
  EXPECT_TRUE(std::any_of(s.modes.begin(), s.modes.end(), [](const sim::ModeEvent& m) {
    return m.reason == "goal_unreachable";
  })) << "this start does not need the planner";
  EXPECT_TRUE(s.converged) << s.verdict;
  ExpectSound(s);
}

TEST(Hold, HomeMotionEndsAtRestInTheReadyPosture) {
  RestWatch watch;
  const sim::Summary s = RunShipped("home", {}, watch.Options(4.0));
  ASSERT_TRUE(s.home_error_rad.has_value());
  std::cout << "home error " << *s.home_error_rad << " rad; fastest joint " << watch.fastest() << " rad/s\n";
  EXPECT_TRUE(s.converged) << s.verdict;
  EXPECT_LT(*s.home_error_rad, 2e-5);
  EXPECT_GT(watch.fastest(), 1.0) << "the motion is too short";
  EXPECT_LT(watch.at_the_end(), kAtRest);
  ExpectSound(s);
}

// A light head: friction that the robot's controller does not compensate moves it easily.
TEST(Hold, HomeMotionOfAGantryIsFollowed) {
  const sim::Summary s =
      RunShipped("home", {"arm.model=gantry", "arm.q_start=[0.25, -0.20, 0.60, 0.30, -0.25, 1.90]",
                          "safety.workspace_radius=2.5"});
  ASSERT_TRUE(s.home_error_rad.has_value());
  std::cout << "home error " << *s.home_error_rad << " rad\n";
  EXPECT_TRUE(s.converged) << s.verdict;
  EXPECT_LT(*s.home_error_rad, 2e-5);
  ExpectSound(s);
}

TEST(Hold, HomeMotionBlockedByABoxIsRefusedAndNotConverged) {
  const sim::Summary s = RunShipped("home", {"safety.boxes=[0.27, -0.03, 0.5, 0.34, 0.03, 0.62]"});
  EXPECT_FALSE(s.converged);
  EXPECT_EQ(LastReason(s), "motion_refused");
  EXPECT_EQ(s.limit_violations, 0U);
}

TEST(Hold, BallNeverInViewLeavesTheArmAtRest) {
  RestWatch watch;
  const sim::Summary s =
      RunShipped("ball", {"target.position=[-0.5, 0.6, 0.04]", "run.duration_s=2"}, watch.Options(2.0));
  EXPECT_FALSE(s.converged);
  EXPECT_EQ(s.frames_detected, 0U);
  EXPECT_EQ(LastMode(s), "hold");
  EXPECT_EQ(LastReason(s), "no_target");
  EXPECT_THAT(s.verdict, HasSubstr("never found in view"));
  EXPECT_LT(watch.fastest(), kAtRest);
  ExpectSound(s);
}

TEST(Hold, LongCameraOutageCoastsThenHoldsThenTracksAgain) {
  RestWatch watch;
  const sim::Summary s = RunShipped("ball", {"faults.camera_outage_s=[0.8, 3.0]"}, watch.Options(8.0));
  PrintResidual(s);
  std::vector<std::string> modes;
  for (const sim::ModeEvent& m : s.modes) {
    modes.push_back(m.mode + (m.reason.empty() ? "" : ":" + m.reason));
  }
  EXPECT_THAT(modes,
              testing::ElementsAre("boot", "hold:no_target", "track", "coast", "hold:target_lost", "track"));
  EXPECT_TRUE(s.converged);
  ExpectSound(s);
}

TEST(Hold, ShortCameraOutageIsBridgedByCoast) {
  const sim::Summary s = RunShipped("ball-moving", {"faults.camera_outage_s=[5.0, 5.4]"});
  PrintResidual(s);
  std::vector<std::string> modes;
  for (const sim::ModeEvent& m : s.modes) {
    modes.push_back(m.mode);
  }
  EXPECT_THAT(modes, testing::ElementsAre("boot", "hold", "track", "coast", "track"));
  EXPECT_TRUE(s.converged);
  ExpectSound(s);
}

}  // namespace
}  // namespace fovea::test
