// A scenario's keys, seen from outside the command line.
#include "sim/scenario/scenario.hpp"

#include <gtest/gtest.h>

#include <set>

#include "fovea/hal/events.hpp"

namespace fovea::sim {
namespace {

// What a fault or a limit sends a person to must be there to be turned.
TEST(ScenarioTest, EveryKeyThatAFaultOrLimitNamesExists) {
  Scenario scenario;
  const config::KeyTable table = ScenarioKeys(scenario);
  std::set<std::string> keys{""};
  for (const config::Key& key : table.keys()) {
    EXPECT_TRUE(keys.insert(key.name).second) << key.name << " stands there twice";
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

}  // namespace
}  // namespace fovea::sim
