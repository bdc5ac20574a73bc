// SPDX-License-Identifier: Apache-2.0
// The keys that may change in motion: their numbers never change, and no key of limits or of the motion law
// is among them.
#include "firmware/core/config/tuning.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "firmware/core/config/servo_config.hpp"

namespace fovea::config {
namespace {

template <class Config>
std::multimap<int, std::string> TunableIn(Config config) {
  std::multimap<int, std::string> keys;
  EachTunable(config, [&keys](const Field& field, double, double min, double max) {
    EXPECT_LT(min, max) << field.key;
    keys.emplace(field.in_motion, field.key);
  });
  return keys;
}

// Logs and boards name a key by its number. A new key gets the next number at the end.
TEST(TuningTest, EachNumberBelongsToOneKeyForEver) {
  EXPECT_THAT(
      TunableIn(ServoConfig{}),
      testing::ElementsAre(testing::Pair(0, "servo.lambda"), testing::Pair(1, "servo.lambda_near"),
                           testing::Pair(2, "servo.lambda_slope"), testing::Pair(3, "servo.damping"),
                           testing::Pair(4, "servo.posture_gain"), testing::Pair(5, "servo.joint_limit_gain"),
                           testing::Pair(6, "servo.manipulability_gain"),
                           testing::Pair(7, "servo.free_speed"), testing::Pair(8, "servo.target_jerk"),
                           testing::Pair(9, "servo.target_turn"), testing::Pair(10, "servo.gate_sigma"),
                           testing::Pair(11, "servo.stale_s"), testing::Pair(12, "servo.coast_s"),
                           testing::Pair(13, "servo.stamp_offset"), testing::Pair(14, "servo.load_offset")));
}

// The proof of a stop assumes that these are fixed.
TEST(TuningTest, LimitsAndMotionLawAreFixed) {
  EXPECT_TRUE(TunableIn(GuardConfig{}).empty());
  EXPECT_TRUE(TunableIn(SafetyConfig{}).empty());
  EXPECT_TRUE(TunableIn(MotionLawConfig{}).empty());
  EXPECT_TRUE(TunableIn(MoveConfig{}).empty());
  EXPECT_TRUE(TunableIn(features::TargetFeature{}).empty());
}

}  // namespace
}  // namespace fovea::config
