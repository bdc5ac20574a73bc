// SPDX-License-Identifier: Apache-2.0
// A shipped arm is found by its name; a mistyped name gets the nearest one and the list.
#include "firmware/host/robots/shipped_robots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "firmware/host/config/input_error.hpp"

namespace fovea::robots {
namespace {

std::string Said(const std::string& name, const std::string& otherwise = "") {
  try {
    return FindShippedRobot(name, "--robot", otherwise).string();
  } catch (const config::InputError& error) {
    return error.what();
  }
}

TEST(ShippedRobotsTest, EveryShippedArmIsFoundByName) {
  EXPECT_EQ(ShippedRobots(), (std::vector<std::string>{"panda", "puma560", "slider", "ur5e"}));
  for (const std::string& name : ShippedRobots()) {
    EXPECT_THAT(Said(name), testing::EndsWith("/robots/" + name + ".toml"));
  }
}

TEST(ShippedRobotsTest, MistypedNameGetsTheNearestAndTheList) {
  EXPECT_EQ(Said("pandda", " (or a path)"),
            "--robot: unknown arm \"pandda\"; did you mean panda?; shipped are panda, puma560, slider, ur5e "
            "(or a path)");
  EXPECT_EQ(Said("quite-another"),
            "--robot: unknown arm \"quite-another\"; shipped are panda, puma560, slider, ur5e");
}

TEST(ShippedRobotsTest, PathIsNoName) {
  for (const char* path : {"../robots/panda", "./panda", "", ".", ".."}) {
    EXPECT_THAT(Said(path), testing::HasSubstr("unknown arm")) << path;
  }
  EXPECT_TRUE(IsRobotPath("arm.toml"));
  EXPECT_TRUE(IsRobotPath("a/arm.urdf"));
  EXPECT_FALSE(IsRobotPath("panda"));
}

}  // namespace
}  // namespace fovea::robots
