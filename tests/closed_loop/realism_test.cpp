// SPDX-License-Identifier: Apache-2.0
// A Panda with its drives, rotors and encoders as they are: the servo's default gains still do the task.
#include <string>

#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

const std::string kPanda = "arm.realism=panda";

struct StillTarget {
  const char* scenario;
  double final_px;
  double final_mm;
};

class RealPanda : public testing::TestWithParam<StillTarget> {};

TEST_P(RealPanda, ReachesAStillTarget) {
  const sim::Summary s = RunShipped(GetParam().scenario, {kPanda});
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.final_error_px_rms.value(), GetParam().final_px);
  EXPECT_LE(s.final_error_mm.value(), GetParam().final_mm);
  EXPECT_EQ(LastMode(s), "track");
  ExpectSound(s);
}
INSTANTIATE_TEST_SUITE_P(Targets, RealPanda,
                         testing::Values(StillTarget{"ball", 0.35, 0.4}, StillTarget{"square", 0.1, 0.1},
                                         StillTarget{"circle", 0.2, 0.2}),
                         [](const auto& target) { return std::string(target.param.scenario); });

// Joints that give, with the encoders on the motors: the camera sees what the encoders do not.
TEST(ElasticPandaTest, ReachesTheBall) {
  const sim::Summary s =
      RunShipped("ball", {kPanda, "arm.joint_stiffness=[14000,14000,14000,14000,9000,9000,9000]",
                          "arm.joint_damping=[20,20,20,20,10,10,10]"});
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.final_error_px_rms.value(), 0.35);
  EXPECT_LE(s.final_error_mm.value(), 0.4);
  ExpectSound(s);
}

TEST(RealPandaTest, TracksAMovingBall) {
  const sim::Summary s = RunShipped("ball-moving", {kPanda});
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.tracking_error_px_rms.value(), 2.8);
  ExpectSound(s);
}

}  // namespace
}  // namespace fovea::test
