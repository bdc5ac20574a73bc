// SPDX-License-Identifier: Apache-2.0
// The servo believes what is not quite true, and the true camera's picture still gets to its goal.
#include <string>
#include <vector>

#include "sim/verdict/target_error.hpp"
#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

struct Beliefs {
  const char* name;
  const char* scenario;
  std::vector<std::string> truth;
};

class WrongBeliefs : public testing::TestWithParam<Beliefs> {};

TEST_P(WrongBeliefs, PictureGetsToItsGoal) {
  const sim::Summary s = RunShipped(GetParam().scenario, GetParam().truth);
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.final_error_px_rms.value(), 0.6);
  // In space, a wrong focal length gives an error in depth, of 2 % at most, and nothing else does.
  EXPECT_GE(s.final_error_depth_mm.value(), 1.0);
  EXPECT_LE(s.final_error_depth_mm.value(), 9.0);
  EXPECT_LE(s.final_error_lateral_mm.value(), 0.3);
  EXPECT_FALSE(s.truth.empty());
  EXPECT_EQ(s.verdict, "converged: the target stands at its goal in the picture");
  ExpectSound(s);
}

const std::string kTurn = "truth.camera.mount_turn_deg=[1, -1, 1]";
const std::string kShift = "truth.camera.mount_xyz.offset=[0.005, -0.005, 0.005]";
const std::string kFocal = "truth.camera.f_px.scale=1.02";
const std::string kLate = "truth.camera.latency_ms.offset=10";
const std::string kHeavy = "truth.arm.link_mass.scale=1.1";
const std::string kLoad = "truth.arm.load_mass.offset=0.2";

INSTANTIATE_TEST_SUITE_P(
    Runs, WrongBeliefs,
    testing::Values(Beliefs{"OfABallAtRandom", "ball-uncertain", {}},
                    Beliefs{"OfABallAllTogether", "ball", {kTurn, kShift, kFocal, kLate, kHeavy, kLoad}},
                    Beliefs{"OfASquareAllTogether", "square", {kTurn, kShift, kFocal, kLate, kHeavy, kLoad}}),
    [](const auto& beliefs) { return std::string(beliefs.param.name); });

// With wrong beliefs, four corners in the picture tell all of the pose. A ball's centre does not tell its
// distance.
TEST(JudgedEye, TakesThePictureOfCornersAloneWhenBeliefsAreWrong) {
  const auto judges_metres = [](const char* scenario, const std::vector<std::string>& truth) {
    return sim::JudgedEyeOf(sim::DescribeRun(sim::LoadScenario(scenario, truth))).judges_metres;
  };
  EXPECT_TRUE(judges_metres("square", {}));
  EXPECT_FALSE(judges_metres("square", {kTurn}));
  EXPECT_FALSE(judges_metres("triangle", {kHeavy}));
  EXPECT_TRUE(judges_metres("ball", {kTurn}));
  EXPECT_TRUE(judges_metres("circle", {kTurn}));
}

// A longer camera sees the target from farther away: the error in depth is the focal length's, and nothing
// else's.
TEST(WrongFocalLength, GivesThatErrorInDepth) {
  const sim::Summary s = RunShipped("ball", {"truth.camera.f_px.scale=1.05"});
  PrintResidual(s);
  const double depth_mm = 1e3 * sim::LoadScenario("ball", {}).servo.goal[2];
  EXPECT_NEAR(s.final_error_depth_mm.value(), 0.05 * depth_mm, 0.005 * depth_mm);
  EXPECT_LE(s.final_error_px_rms.value(), 0.5);
}

// The pictures are older or newer than the servo believes, by as much as three times servo.stamp_sigma.
struct Late {
  const char* name;
  const char* scenario;
  int by_ms;
};

class WrongLatency : public testing::TestWithParam<Late> {};

TEST_P(WrongLatency, LeavesTheArmCalm) {
  const std::string late = "truth.camera.latency_ms.offset=" + std::to_string(GetParam().by_ms);
  const sim::Summary s = RunShipped(GetParam().scenario, {late});
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.final_error_px_rms.value(), 0.2);
  ExpectSound(s);
}

INSTANTIATE_TEST_SUITE_P(Runs, WrongLatency,
                         testing::Values(Late{"OfABallTooSmall", "ball", 30},
                                         Late{"OfABallTooLarge", "ball", -30},
                                         Late{"OfASquareTooSmall", "square", 30},
                                         Late{"OfASquareTooLarge", "square", -30}),
                         [](const auto& late) { return std::string(late.param.name); });

// The mount is turned about the camera's axis: steering leads away. The servo sees that, and holds.
struct Turned {
  const char* name;
  const char* scenario;
  int by_deg;
  const char* place = "run.seed=1";  // or the target's, wholly in such a picture
};

class TurnedMount : public testing::TestWithParam<Turned> {};

TEST_P(TurnedMount, IsNoticedBeforeALimitIsUsedUp) {
  const std::string turn = "truth.camera.mount_turn_deg=[0, 0, " + std::to_string(GetParam().by_deg) + "]";
  const sim::Summary s = RunShipped(GetParam().scenario, {turn, GetParam().place});
  EXPECT_FALSE(s.converged);
  EXPECT_EQ(LastMode(s), "hold");
  EXPECT_EQ(LastReason(s), "eye_doubted");
  ExpectSound(s);
}

// At its usual place the square's fourth corner is out of such a picture from the start: it is lost before
// anything has shifted by more than a pixel, and the arm stops.
TEST(TurnedMountTest, SquareAtThePicturesEdgeIsLostAtOnce) {
  const sim::Summary s = RunShipped("square", {"truth.camera.mount_turn_deg=[0, 0, 90]"});
  EXPECT_FALSE(s.converged);
  EXPECT_EQ(LastMode(s), "hold");
  ExpectSound(s);
}

INSTANTIATE_TEST_SUITE_P(
    Runs, TurnedMount,
    testing::Values(Turned{"OfABall", "ball", 90},
                    Turned{"OfASquare", "square", 90, "target.position=[0.46, 0.06, 0.02]"},
                    Turned{"OfADisc", "circle", -90}, Turned{"OfABallUpsideDown", "ball", 180},
                    Turned{"OfASquareUpsideDown", "square", 180}),
    [](const auto& turned) { return std::string(turned.param.name); });

}  // namespace
}  // namespace fovea::test
