// SPDX-License-Identifier: Apache-2.0
// The servo believes what is not quite true, and the true camera's picture still gets to its goal.
#include <string>
#include <vector>

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
const std::string kLate = "truth.camera.latency_ms.offset=5";
const std::string kHeavy = "truth.arm.link_mass.scale=1.1";
const std::string kLoad = "truth.arm.load_mass.offset=0.2";

INSTANTIATE_TEST_SUITE_P(
    Runs, WrongBeliefs,
    testing::Values(Beliefs{"OfABallAtRandom", "ball-uncertain", {}},
                    Beliefs{"OfABallAllTogether", "ball", {kTurn, kShift, kFocal, kLate, kHeavy, kLoad}},
                    Beliefs{"OfASquareAllTogether", "square", {kTurn, kShift, kFocal, kLate, kHeavy, kLoad}}),
    [](const auto& beliefs) { return std::string(beliefs.param.name); });

// A longer camera sees the target from farther away: the error in depth is the focal length's, and nothing
// else's.
TEST(WrongFocalLength, GivesThatErrorInDepth) {
  const sim::Summary s = RunShipped("ball", {"truth.camera.f_px.scale=1.05"});
  PrintResidual(s);
  const double depth_mm = 1e3 * sim::LoadScenario("ball", {}).servo.goal[2];
  EXPECT_NEAR(s.final_error_depth_mm.value(), 0.05 * depth_mm, 0.005 * depth_mm);
  EXPECT_LE(s.final_error_px_rms.value(), 0.5);
}

}  // namespace
}  // namespace fovea::test
