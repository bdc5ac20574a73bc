// SPDX-License-Identifier: Apache-2.0
// The words of servo.learn.
#include <gtest/gtest.h>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/servo_keys.hpp"

namespace fovea::config {
namespace {

LearntQuantities Of(const std::string& text) {
  ServoSettings settings;
  settings.learn = text;
  return LearntOf(settings);
}

TEST(LearntQuantitiesTest, AreOffByDefaultAndEachAlone) {
  EXPECT_FALSE(Of("").latency || Of("").payload);
  EXPECT_TRUE(Of("latency").latency);
  EXPECT_FALSE(Of("latency").payload);
  EXPECT_TRUE(Of("payload").payload);
  EXPECT_FALSE(Of("payload").latency);
  EXPECT_TRUE(Of("payload, latency").latency && Of("payload,latency").payload);
}

TEST(LearntQuantitiesTest, UnknownWordsAreRefusedInOneLine) {
  for (const char* text : {"latncy", ",", " ", "latency;payload", "Latency", "all"}) {
    try {
      static_cast<void>(Of(text));
      ADD_FAILURE() << "\"" << text << "\" was allowed";
    } catch (const InputError& error) {
      const std::string words = error.what();
      EXPECT_EQ(words.find("servo.learn = \"" + std::string(text) + "\" is not allowed: "), 0U) << words;
      EXPECT_EQ(words.find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace fovea::config
