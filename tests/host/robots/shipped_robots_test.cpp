// SPDX-License-Identifier: Apache-2.0
// A shipped arm is found by its name; a mistyped name gets the nearest one and the list.
#include "firmware/host/robots/shipped_robots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "firmware/host/config/input_error.hpp"

namespace fovea::robots {
namespace {

constexpr const char* kShipped =
    "; shipped are gantry, panda, puma560, slider, ur5e (or give the path of an arm file .toml or of a "
    ".urdf)";

std::string Said(const std::string& name) {
  try {
    return FindRobot(name, "--robot").string();
  } catch (const config::InputError& error) {
    return error.what();
  }
}

TEST(ShippedRobotsTest, EveryShippedArmIsFoundByName) {
  EXPECT_EQ(ShippedRobots(), (std::vector<std::string>{"gantry", "panda", "puma560", "slider", "ur5e"}));
  for (const std::string& name : ShippedRobots()) {
    EXPECT_THAT(Said(name), testing::EndsWith("/robots/" + name + ".toml"));
  }
}

TEST(ShippedRobotsTest, MistypedNameGetsTheNearestAndTheList) {
  EXPECT_EQ(Said("pandda"), std::string("--robot: unknown arm \"pandda\"; did you mean panda?") + kShipped);
  EXPECT_EQ(Said("quite-another"), std::string("--robot: unknown arm \"quite-another\"") + kShipped);
}

TEST(ShippedRobotsTest, PathIsNoName) {
  for (const char* path : {"../robots/panda", "./panda", "", ".", ".."}) {
    EXPECT_THAT(Said(path), testing::HasSubstr("unknown arm")) << path;
  }
  for (const char* path : {"arm.toml", "a/arm.urdf", "../robots/panda.toml"}) {
    EXPECT_EQ(Said(path), path);
  }
  EXPECT_TRUE(IsRobotPath("arm.toml"));
  EXPECT_TRUE(IsRobotPath("a/arm.urdf"));
  EXPECT_FALSE(IsRobotPath("panda"));
}

}  // namespace
}  // namespace fovea::robots
