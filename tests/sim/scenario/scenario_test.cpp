// SPDX-License-Identifier: Apache-2.0
// A scenario's keys, without the command line.
#include "sim/scenario/scenario.hpp"

#include <gtest/gtest.h>

#include <set>

#include "firmware/host/config/input_error.hpp"
#include "fovea/hal/events.hpp"
#include "sim/scenario/compose.hpp"
#include "sim/scenario/run_description.hpp"

namespace fovea::sim {
namespace {

// A key that a fault or limit refers to must exist.
TEST(ScenarioTest, EveryKeyThatAFaultOrLimitNamesExists) {
  Scenario scenario;
  const config::KeyTable table = ScenarioKeys(scenario);
  std::set<std::string> keys{""};
  for (const config::Key& key : table.keys()) {
    EXPECT_TRUE(keys.insert(key.name).second) << key.name << " exists twice";
  }
  for (int i = 0; i < hal::kNumFaults; ++i) {
    EXPECT_EQ(keys.count(hal::Key(static_cast<hal::Fault>(i))), 1U) << hal::Key(static_cast<hal::Fault>(i));
  }
  for (int i = 0; i < hal::kNumLimits; ++i) {
    EXPECT_EQ(keys.count(hal::Key(static_cast<hal::Limit>(i))), 1U) << hal::Key(static_cast<hal::Limit>(i));
  }
}

TEST(ScenarioTest, EveryRenamedKeyHasASuccessorAndIsNoKeyItself) {
  Scenario scenario;
  const config::KeyTable table = ScenarioKeys(scenario);
  std::set<std::string> keys;
  for (const config::Key& key : table.keys()) {
    keys.insert(key.name);
  }
  EXPECT_FALSE(table.successors().empty());
  for (const auto& [former, today] : table.successors()) {
    EXPECT_EQ(keys.count(former), 0U) << former;
    EXPECT_EQ(keys.count(today), 1U) << today;
  }
}

TEST(ScenarioTest, HueFollowsTheTargetsColourUnlessItIsSet) {
  const auto hue = [](const std::vector<std::string>& assignments) {
    return LoadScenario("ball", assignments).vision.config.colour.hue_deg;
  };
  EXPECT_EQ(hue({}), 0.0);
  EXPECT_NEAR(hue({"target.colour=[0.1, 0.1, 0.8]"}), 240.0, 1e-9);
  EXPECT_NEAR(hue({"target.colour=[0.1, 0.8, 0.1]"}), 120.0, 1e-9);
  EXPECT_NEAR(hue({"target.colour=[0.8, 0.45, 0.1]"}), 30.0, 1e-9);
  EXPECT_NEAR(hue({"target.colour=[0.8, 0.1, 0.45]"}), 330.0, 1e-9);
  EXPECT_NEAR(hue({"target.colour=[0.1, 0.1, 0.8]", "vision.hue_deg=30"}), 30.0, 1e-9);
  EXPECT_EQ(hue({"target.colour=[0.5, 0.5, 0.5]"}), 0.0) << "gray has no hue";
}

TEST(ScenarioTest, IntrinsicsAreTakenWholeOrRefused) {
  const auto pinhole = [](const std::vector<std::string>& assignments) {
    return MakeScenarioPinhole(LoadScenario("ball", assignments));
  };
  EXPECT_TRUE(pinhole({}).IsPlain());
  const std::vector<std::string> all{"camera.f_u_px=571.3", "camera.f_v_px=566.9", "camera.c_u_px=301.7",
                                     "camera.c_v_px=252.2"};
  const Pinhole own = pinhole(all);
  EXPECT_FALSE(own.IsPlain());
  EXPECT_EQ(own.f_px, 571.3);
  EXPECT_DOUBLE_EQ(own.FocalV(), 566.9);
  EXPECT_EQ(own.c_v_px, 252.2);
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::vector<std::string> some = all;
    some.erase(some.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_THROW(pinhole(some), config::InputError) << "without " << all[i];
  }
  std::vector<std::string> outside = all;
  outside.emplace_back("camera.c_u_px=640");
  EXPECT_THROW(pinhole(outside), config::InputError);
}

TEST(ScenarioTest, StartFasterThanALimitIsRefused) {
  const auto describe = [](const std::string& dq) {
    DescribeRun(LoadScenario("ball", {"arm.dq_start=" + dq}));
  };
  EXPECT_NO_THROW(describe("[0.1, 0.1, 0, 0, 0, 0, 0]"));
  EXPECT_THROW(describe("[2, 2, 2, 2, 2, 2, 2]"), config::InputError) << "a joint is too fast";
  EXPECT_THROW(describe("[0, 0, 0, 0, 2, 0, 2]"), config::InputError) << "the hand is too fast";
}

TEST(ScenarioTest, MoreFrictionCompensationThanFrictionIsRefused) {
  const auto describe = [](const std::vector<std::string>& keys) { DescribeRun(LoadScenario("ball", keys)); };
  EXPECT_NO_THROW(describe({"servo.friction_compensation=0.1", "arm.friction_compensation=0.9"}));
  EXPECT_THROW(describe({"servo.friction_compensation=0.2", "arm.friction_compensation=0.9"}),
               config::InputError);
}

}  // namespace
}  // namespace fovea::sim
