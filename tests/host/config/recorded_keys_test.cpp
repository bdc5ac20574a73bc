// SPDX-License-Identifier: Apache-2.0
// Keys of a log, by the names of today and of former programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/key_table.hpp"

namespace fovea::config {
namespace {

using testing::ElementsAre;

class RecordedKeysTest : public testing::Test {
 protected:
  RecordedKeysTest() {
    table_.Number("camera.latency_ms", latency_ms_, 0.0, 500.0, "ms", "");
    table_.Number("arm.load_mass", mass_, 0.0, 100.0, "kg", "");
    table_.Renamed("camera.delay_ms", "camera.latency_ms");
  }
  double latency_ms_ = 40.0;
  double mass_ = 0.25;
  KeyTable table_;
};

TEST_F(RecordedKeysTest, KeysAreAppliedByTheirFormerNamesToo) {
  EXPECT_THAT(table_.ApplyRecorded({{"camera.delay_ms", "55"}, {"servo.lambda", "3"}}),
              ElementsAre("camera.latency_ms"));
  EXPECT_EQ(latency_ms_, 55.0);
  EXPECT_EQ(mass_, 0.25);
}

TEST_F(RecordedKeysTest, RecordedDefaultsCountAsRecorded) {
  EXPECT_THAT(table_.ApplyRecorded(table_.Values()), ElementsAre("arm.load_mass", "camera.latency_ms"));
  EXPECT_EQ(latency_ms_, 40.0);
}

TEST_F(RecordedKeysTest, ValueOutOfRangeIsRefused) {
  EXPECT_THROW(table_.ApplyRecorded({{"arm.load_mass", "-1"}}), InputError);
}

}  // namespace
}  // namespace fovea::config
