// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/fault_panel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/host/config/input_error.hpp"
#include "tests/support/input_error.hpp"

namespace fovea::sim {
namespace {

const FaultSwitch& Of(const std::vector<FaultSwitch>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const FaultSwitch& f) { return f.name == name; });
  if (found == all.end()) {
    throw std::logic_error("no fault " + name);
  }
  return *found;
}

TEST(FaultPanel, HasEachFaultOfTheKeysWithItsSizes) {
  FaultSettings settings;
  const FaultPanel panel(settings, 7);
  const std::vector<FaultSwitch> all = panel.Switches(0.0);
  // By the keys, independently of the panel: a key that ends with _s and is a pair of times is a fault.
  FaultSettings for_keys;
  config::KeyTable keys;
  AddFaultKeys(for_keys, keys);
  std::size_t faults = 0;
  for (const config::Key& key : keys.keys()) {
    const bool is_window = key.name.ends_with("_s") && key.kind == "a list of 2 numbers";
    if (is_window && key.name != "faults.nothing_s") {
      ++faults;
      const std::string name = key.name.substr(7, key.name.size() - 9);
      EXPECT_NO_THROW(Of(all, name)) << name;
    }
  }
  EXPECT_EQ(all.size(), faults);
  EXPECT_GT(faults, 15U);
  EXPECT_EQ(Of(all, "push").sizes.size(), 7U);
  EXPECT_EQ(Of(all, "glare").sizes.size(), 3U);
  EXPECT_EQ(Of(all, "load").sizes.at(0).name, "load_mass");
  EXPECT_EQ(Of(all, "clock_jump").sizes.at(0).value, 50.0);  // ms, as in its key
}

TEST(FaultPanel, StartsResizesAndStops) {
  FaultPanel panel({}, 7);
  panel.Start("load", {{"load_mass", 2.5}}, 3.0);
  EXPECT_TRUE(Of(panel.Switches(3.0), "load").active);
  EXPECT_FALSE(Of(panel.Switches(2.999), "load").active);
  EXPECT_EQ(panel.faults().bench.load.mass, 2.5);
  panel.Start("load", {{"load_mass", 1.0}}, 4.0);
  EXPECT_EQ(panel.faults().bench.load.window.start_s, 3.0) << "it has not started anew";
  EXPECT_EQ(panel.faults().bench.load.mass, 1.0);
  panel.Stop("load", 5.0);
  EXPECT_FALSE(Of(panel.Switches(5.0), "load").active);
  EXPECT_TRUE(panel.faults().bench.load.window.Contains(4'999'000'000));
  panel.Start("load", {}, 6.0);
  EXPECT_TRUE(Of(panel.Switches(6.0), "load").active);
  EXPECT_EQ(panel.faults().bench.load.mass, 1.0);
}

// Otherwise the window would begin anew, and a stop before the next step would leave none: the load that
// acted before would hang for ever.
TEST(FaultPanel, AFaultThatHasJustEndedGoesOn) {
  FaultPanel panel({}, 7);
  panel.Start("load", {}, 1.0);
  panel.Stop("load", 3.0);
  panel.Start("load", {}, 3.001);
  EXPECT_EQ(panel.faults().bench.load.window.start_s, 1.0);
  panel.Stop("load", 3.001);
  EXPECT_TRUE(panel.faults().bench.load.window.Begins());
  EXPECT_FALSE(Of(panel.Switches(3.001), "load").active);
}

TEST(FaultPanel, StopsAFaultThatTheScenarioPlanned) {
  FaultSettings settings;
  settings.bench.camera_outage = {2.0, 8.0};
  FaultPanel panel(settings, 7);
  panel.Stop("camera_outage", 1.0);
  EXPECT_FALSE(panel.faults().bench.camera_outage.Begins());
}

TEST(FaultPanel, SetsListsAndCountsJointsFromOne) {
  FaultPanel panel({}, 7);
  panel.Start("push", {{"push[2]", 12.0}}, 1.0);
  EXPECT_EQ(panel.faults().bench.push.tau.size(), 7);
  EXPECT_EQ(panel.faults().bench.push.tau[1], 12.0);
  panel.Start("encoder_stuck", {{"encoder_stuck_joint", 4.0}}, 1.0);
  EXPECT_EQ(panel.faults().arm.stuck.joint, 3);
  panel.Start("freeze", {{"freeze_pixels", 1.0}}, 1.0);
  EXPECT_TRUE(panel.faults().frames.freeze_pixels);
}

TEST(FaultPanel, RefusesWithoutAnyChange) {
  FaultPanel panel({}, 7);
  const auto refused = [&](const std::string& name, const std::map<std::string, double>& sizes) {
    return test::InputErrorOf([&] { panel.Start(name, sizes, 1.0); });
  };
  EXPECT_EQ(refused("lod", {}), "there is no fault \"lod\"");
  EXPECT_EQ(refused("load", {{"mass", 1.0}}), "the fault \"load\" has no \"mass\"");
  EXPECT_EQ(refused("load", {{"load_mass", 101.0}}),
            "faults.load_mass = 101 is not allowed: expected a number, 0 to 100 kg");
  EXPECT_NE(refused("load", {{"load_mass", std::numeric_limits<double>::quiet_NaN()}}), "");
  EXPECT_EQ(refused("torque_loss", {{"torque_loss_joint", 1.5}}),
            "faults.torque_loss_joint = 1.5 is not allowed: expected a whole number, 1 to 7");
  EXPECT_EQ(refused("encoder_nan", {{"encoder_nan_joint", 8.0}}),
            "faults.encoder_nan_joint = 8 is not allowed: expected a whole number, 1 to 7");
  EXPECT_NE(refused("glare", {{"glare_px[3]", 0.0}}), "") << "a spot without size";
  EXPECT_NE(refused("push", {}), "") << "a push without a torque";
  for (const FaultSwitch& fault : panel.Switches(1.0)) {
    EXPECT_FALSE(fault.active) << fault.name;
  }
  EXPECT_EQ(panel.faults().bench.load.mass, BenchFaults{}.load.mass);
  EXPECT_EQ(test::InputErrorOf([&] { panel.Stop("lod", 1.0); }), "there is no fault \"lod\"");
}

}  // namespace
}  // namespace fovea::sim
