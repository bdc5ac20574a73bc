// SPDX-License-Identifier: Apache-2.0
// A soak of a few minutes, with the normal clock and with one at the end of its range.
#include "tests/soak/soak.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>

namespace fovea::soak {
namespace {

using testing::IsEmpty;

SoakOptions Minutes(double minutes, const char* scenario = "ball") {
  SoakOptions options;
  options.scenario = scenario;
  options.hours = minutes / 60.0;
  return options;
}

void Print(const SoakResult& result) {
  std::cout << result.ticks << " ticks, " << result.recoveries << " recoveries, grew by "
            << result.resident_growth / 1024.0 << " KiB resident, " << result.heap_growth / 1024.0
            << " KiB in use\n";
}

// The servo uses only differences of stamps: 30 h before the end of the clock's range, and with counters that
// pass 2^32, every torque is bit-identical.
TEST(SoakTest, RunIsBitExactUnderALateClock) {
  const SoakResult early = RunSoak(Minutes(2.0));
  Print(early);
  EXPECT_THAT(early.failures, IsEmpty());
  EXPECT_GT(early.recoveries, 0U);
  EXPECT_EQ(early.ticks + early.missed_ticks, 120'000U);

  SoakOptions options = Minutes(2.0);
  options.late_clock = true;
  const SoakResult late = RunSoak(options);
  Print(late);
  EXPECT_THAT(late.failures, IsEmpty());
  EXPECT_EQ(late.digest, early.digest);
}

TEST(SoakTest, AnotherSeedGivesAnotherRun) {
  SoakOptions options = Minutes(0.5);
  options.passes = 1;
  const SoakResult one = RunSoak(options);
  options.seed = 2;
  EXPECT_NE(RunSoak(options).digest, one.digest);
}

TEST(SoakTest, FlatTargetRunHasNoFailures) {
  const SoakResult result = RunSoak(Minutes(1.0, "square"));
  Print(result);
  EXPECT_THAT(result.failures, IsEmpty());
}

TEST(SoakTest, CameraRunHasNoFailures) {
  SoakOptions options = Minutes(0.5);
  options.camera = true;
  const SoakResult result = RunSoak(options);
  Print(result);
  EXPECT_THAT(result.failures, IsEmpty());
}

}  // namespace
}  // namespace fovea::soak
