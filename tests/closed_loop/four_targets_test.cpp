// SPDX-License-Identifier: Apache-2.0
// Scenarios of all targets and motions on the simulated arm, with friction and encoder noise. Measurements
// are the truth plus 0.05 px of noise: the error that remains is the servo's own.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/closed_loop/closed_loop.hpp"
#include "tests/closed_loop/truth_run.hpp"

namespace fovea::test {
namespace {

void Print(const sim::Summary& s) {
  PrintResidual(s);
  if (s.final_error_deg) {
    std::cout << "  " << *s.final_error_deg << " deg\n";
  }
}

class StillTarget : public testing::TestWithParam<const char*> {};

TEST_P(StillTarget, ConvergesToTheGoal) {
  const sim::Summary s = RunByTruth(GetParam());
  Print(s);
  EXPECT_TRUE(s.converged);
  EXPECT_GE(s.start_error_px.value(), 100.0);
  EXPECT_LE(s.final_error_px_rms.value(), 0.5);
  EXPECT_LE(s.final_error_mm.value(), 1.0);
  EXPECT_LE(s.final_error_deg.value_or(0.0), 0.2);
  EXPECT_EQ(s.limit_violations, 0U);
  EXPECT_TRUE(s.faults.empty());
}
INSTANTIATE_TEST_SUITE_P(Scenarios, StillTarget,
                         testing::Values("ball", "ball-jump", "circle", "square", "triangle"),
                         [](const auto& c) {
                           std::string name = c.param;
                           std::erase(name, '-');
                           return name;
                         });

// From these starts the visual law, which goes downhill, ends at a limit: a triangle that needs another
// posture, and a square whose nearest of four goals lies outside the workspace.
TEST(FarGoal, TriangleIsReachedByAnotherPosture) {
  const sim::Summary s = RunByTruth(
      "triangle", {"arm.q_start=[-0.1256,1.1934,-2.1153,-1.6094,0.3756,1.2153,-2.4184]",
                   "target.position=[-0.3945,-0.3287,0.0338]", "target.rpy_deg=[-155.83,2.12,67.80]"});
  Print(s);
  EXPECT_TRUE(s.converged) << s.verdict;
  EXPECT_EQ(s.limit_violations, 0U);
}

TEST(FarGoal, SquareTakesTheReachableOneOfItsFourGoals) {
  const sim::Summary s = RunByTruth(
      "square", {"arm.q_start=[-1.8973,-1.4749,-1.2370,-2.7403,0.0384,2.4767,1.1987]",
                 "target.position=[-0.4333,-0.8067,0.5195]", "target.rpy_deg=[107.25,16.49,-9.21]"});
  Print(s);
  EXPECT_TRUE(s.converged) << s.verdict;
  EXPECT_EQ(s.limit_violations, 0U);
}

class MovingTarget : public testing::TestWithParam<const char*> {};

TEST_P(MovingTarget, PredictionCutsTheTrackingErrorFivefold) {
  const sim::Summary with = RunByTruth(GetParam());
  const sim::Summary without = RunByTruth(GetParam(), {"servo.predict=false"});
  Print(with);
  Print(without);
  EXPECT_TRUE(with.converged);
  EXPECT_LE(with.tracking_error_px_rms.value(), 3.0);
  EXPECT_LE(with.tracking_error_px_rms.value(), without.tracking_error_px_rms.value() / 5.0);
  EXPECT_EQ(with.limit_violations, 0U);
}
INSTANTIATE_TEST_SUITE_P(Scenarios, MovingTarget, testing::Values("ball-moving", "ball-line", "ball-eight"),
                         [](const auto& c) {
                           std::string name = c.param;
                           std::erase(name, '-');
                           return name;
                         });

// A square that moves on a circle and turns: all six degrees of freedom move.
TEST(MovingSquare, IsTrackedInAllSixDegreesOfFreedom) {
  const sim::Summary s =
      RunByTruth("square", {"target.motion=circle", "target.path_radius=0.06", "target.speed=0.1",
                            "target.turn_deg_s=8", "run.duration_s=10", "run.tracking_bound_px=5"});
  Print(s);
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.tracking_error_px_rms.value(), 3.0);
}

}  // namespace
}  // namespace fovea::test
