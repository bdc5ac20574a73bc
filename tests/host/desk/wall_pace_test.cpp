// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/desk/wall_pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace fovea::desk {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// A simulation whose ticks take `tick_ns` of wall time each. Waits as the pace says, at most until
// `end_wall_ns`.
struct Simulation {
  WallPace pace;
  std::int64_t tick_ns;
  std::int64_t now_ns = 0;
  std::int64_t wall_ns = 5'000 * kMs;

  void RunUntil(std::int64_t end_wall_ns) {
    while (wall_ns < end_wall_ns) {
      const std::int64_t wait_ns = pace.WaitNs(now_ns + kMs, wall_ns);
      if (wait_ns > 0) {
        wall_ns += std::min<std::int64_t>(wait_ns, kMs);  // a real wait is short, so that it can be ended
        continue;
      }
      pace.Begin(now_ns + kMs, wall_ns);
      now_ns += kMs;
      wall_ns += tick_ns;
    }
  }
};

TEST(WallPace, KeepsEachSpeed) {
  for (const double speed : {1.0, 0.5, 0.1}) {
    Simulation run{WallPace(speed), 100'000};
    const std::int64_t begin_ns = run.wall_ns;
    run.RunUntil(begin_ns + 4'000 * kMs);
    EXPECT_NEAR(static_cast<double>(run.now_ns), speed * 4e9, 3e6) << speed;
    EXPECT_NEAR(run.pace.achieved(), speed, 0.03 * speed) << speed;
  }
}

TEST(WallPace, FreeSpeedNeverWaits) {
  Simulation run{WallPace(WallPace::kFree), 100'000};
  const std::int64_t begin_ns = run.wall_ns;
  run.RunUntil(begin_ns + 1'000 * kMs);
  EXPECT_EQ(run.now_ns, 10'000 * kMs);
  EXPECT_NEAR(run.pace.achieved(), 10.0, 0.1);
}

TEST(WallPace, PauseStopsAndStepsAreCounted) {
  Simulation run{WallPace(1.0), 100'000};
  run.RunUntil(run.wall_ns + 500 * kMs);
  run.pace.Pause();
  const std::int64_t paused_ns = run.now_ns;
  run.RunUntil(run.wall_ns + 5'000 * kMs);
  EXPECT_EQ(run.now_ns, paused_ns);
  EXPECT_EQ(run.pace.achieved(), 0.0);
  run.pace.Step(7);
  run.RunUntil(run.wall_ns + 1'000 * kMs);
  EXPECT_EQ(run.now_ns, paused_ns + 7 * kMs);
  EXPECT_TRUE(run.pace.paused());
  run.pace.Resume();
  const std::int64_t resumed_wall_ns = run.wall_ns;
  run.RunUntil(resumed_wall_ns + 1'000 * kMs);
  EXPECT_NEAR(static_cast<double>(run.now_ns - paused_ns), 1'007e6, 3e6)
      << "the time of the pause is not made up for";
}

TEST(WallPace, LostTimeIsNotMadeUpFor) {
  Simulation run{WallPace(1.0), 2'000'000};  // half as fast as the wall
  run.RunUntil(run.wall_ns + 4'000 * kMs);
  EXPECT_NEAR(run.pace.achieved(), 0.5, 0.02);
  run.tick_ns = 10'000;
  const std::int64_t slow_ns = run.now_ns;
  run.RunUntil(run.wall_ns + 1'000 * kMs);
  EXPECT_LE(run.now_ns - slow_ns, 1'000 * kMs + WallPace::kMostBehindNs + 2 * kMs);
}

TEST(WallPace, ANewSpeedBeginsNow) {
  Simulation run{WallPace(1.0), 100'000};
  run.RunUntil(run.wall_ns + 2'000 * kMs);
  const std::int64_t at_ns = run.now_ns;
  run.pace.SetSpeed(0.25);
  run.RunUntil(run.wall_ns + 2'000 * kMs);
  EXPECT_NEAR(static_cast<double>(run.now_ns - at_ns), 500e6, 3e6);
}

}  // namespace
}  // namespace fovea::desk
