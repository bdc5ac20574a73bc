// SPDX-License-Identifier: Apache-2.0
// Viewers see the findings, and of the joints only what is wrong.
#include "firmware/host/desk/found.hpp"

#include <gtest/gtest.h>

namespace fovea::desk {
namespace {

TEST(FoundTest, ShowsAllButWhatIsRightOfJoints) {
  beliefs::Findings findings;
  findings.beliefs = {{"latency", "camera.latency_ms", "ms", 18.0, 0.4, 5.0, 1.0, 40.0},
                      {"focal length", "camera.f_u_px", "%", 3.0, 20.0, 1.0, 0.2},
                      {"encoder zero of joint 2", "", "deg", 0.01, 0.01, 0.05, 0.05},
                      {"Coulomb friction left in joint 3", "arm.coulomb", "Nm", 1.0, 0.01, 0.4, 0.1}};
  live::State state;
  Fill(&findings, state);
  ASSERT_EQ(state.findings.size(), 3U);
  EXPECT_EQ(state.findings[0],
            (live::FindingState{"latency", "camera.latency_ms", "ms", 40.0, true, 18.0, 0.4}));
  EXPECT_FALSE(state.findings[1].known);
  EXPECT_EQ(state.findings[2].name, "Coulomb friction left in joint 3");
  Fill(nullptr, state);
  EXPECT_TRUE(state.findings.empty());
}

}  // namespace
}  // namespace fovea::desk
