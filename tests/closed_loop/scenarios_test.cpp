// SPDX-License-Identifier: Apache-2.0
// The shipped scenarios reach their goals.
#include <algorithm>

#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

class StillBall : public testing::TestWithParam<const char*> {};

TEST_P(StillBall, ConvergesToTheGoal) {
  const sim::Summary s = RunShipped(GetParam());
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_GE(s.start_error_px.value(), 150.0);
  EXPECT_LE(s.final_error_px_rms.value(), 0.5);
  EXPECT_LE(s.final_error_mm.value(), 1.0);
  EXPECT_LE(s.final_error_lateral_mm.value(), 0.4);
  EXPECT_EQ(s.frames, 240U);
  EXPECT_EQ(s.frames_detected, s.frames);
  EXPECT_EQ(LastMode(s), "track");
  ExpectSound(s);
}
INSTANTIATE_TEST_SUITE_P(Scenarios, StillBall,
                         testing::Values("ball", "ball-dark", "ball-clutter", "ball-ur5e", "ball-puma560"),
                         [](const auto& scenario) {
                           std::string name = scenario.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

// Another arm; another world: links and lines of sight go round boxes.
class StillPlate : public testing::TestWithParam<const char*> {};

TEST_P(StillPlate, ConvergesToTheGoal) {
  const sim::Summary s = RunShipped(GetParam());
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_GE(s.start_error_px.value(), 100.0);
  EXPECT_LE(s.final_error_px_rms.value(), 0.1);
  EXPECT_LE(s.final_error_mm.value(), 0.15);
  EXPECT_LE(s.final_error_deg.value(), 0.2);
  EXPECT_EQ(LastMode(s), "track");
  ExpectSound(s);
}
INSTANTIATE_TEST_SUITE_P(Scenarios, StillPlate, testing::Values("triangle-gantry", "square-boxes"),
                         [](const auto& scenario) {
                           std::string name = scenario.param;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name;
                         });

// Half a second without sight: the arm goes on by prediction and arrives no later.
TEST(OccludedBall, IsReachedByPrediction) {
  const sim::Summary s = RunShipped("ball-occluded");
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_EQ(s.frames - s.frames_detected, 15U);
  EXPECT_EQ(std::count_if(s.modes.begin(), s.modes.end(), [](const auto& m) { return m.mode == "coast"; }),
            1);
  EXPECT_LT(s.settle_time_s.value(), 2.6);
  ExpectSound(s);
}

// A push of 0.06 Ns, once the arm stands over the ball, makes it roll 0.11 m. The filter may reject up to
// three frames until it follows the ball.
TEST(PushedBall, IsTrackedUntilItStops) {
  sim::RunOptions options;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  double fastest = 0.0;
  options.observer.on_truth = [&](const sim::Truth& truth) {
    if (truth.stamp_ns == 0) {
      first = truth.p_BO;
    } else {
      fastest = std::max(fastest, 1e3 * (truth.p_BO - last).norm());
    }
    last = truth.p_BO;
  };
  const sim::Summary s = RunShipped("ball-pushed", {}, options);
  PrintResidual(s);
  const double rolled = (last - first).norm();
  std::cout << "the ball rolled " << rolled << " m, at most at " << fastest << " m/s\n";
  EXPECT_GT(rolled, 0.10);
  EXPECT_NEAR(fastest, 0.3, 0.01);
  EXPECT_TRUE(s.converged);
  EXPECT_EQ(s.frames_detected, s.frames);
  EXPECT_LE(s.final_error_px_rms.value(), 0.3);
  EXPECT_LE(s.final_error_mm.value(), 1.0);
  EXPECT_LE(s.settle_time_s.value(), 5.5);
  EXPECT_EQ(LastMode(s), "track");
  ExpectSound(s);
}

// Without colour the detector finds the ball by its roundness, on a bench where nothing else is round.
TEST(GrayBall, ConvergesToTheGoal) {
  const sim::Summary s = RunShipped("ball", {"vision.method=gray"});
  PrintResidual(s);
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.final_error_px_rms.value(), 0.5);
  EXPECT_EQ(s.frames_detected, s.frames);
  ExpectSound(s);
}

TEST(MovingBall, PredictionCutsTheTrackingErrorFivefold) {
  const sim::Summary with = RunShipped("ball-moving");
  const sim::Summary without = RunShipped("ball-moving", {"servo.predict=false"});
  PrintResidual(with);
  PrintResidual(without);
  EXPECT_TRUE(with.converged);
  EXPECT_LE(with.tracking_error_px_rms.value(), 3.0);
  EXPECT_LE(with.tracking_error_px_rms.value(), without.tracking_error_px_rms.value() / 5.0);
  ExpectSound(with);
  ExpectSound(without);
}

// Time jumps to each deadline, and every 500th time 3.2 ms past it, like a computer that wakes the loop late.
class LateClock final : public hal::Clock {
 public:
  std::uint64_t late_waits = 0;

 private:
  [[nodiscard]] std::int64_t DoNowNs() const noexcept override { return now_ns_; }
  hal::Status DoWaitUntil(std::int64_t deadline_ns) noexcept override {
    now_ns_ = std::max(now_ns_, deadline_ns);
    if (++waits_ % 500 == 0) {
      ++late_waits;
      now_ns_ += 3'200'000;
    }
    return hal::Status::Ok();
  }
  std::int64_t now_ns_ = 0;
  int waits_ = 0;
};

// The computer's load does not matter here: only this clock makes the loop late, so the counts are exact.
TEST(RealPace, ConvergesAndReportsItsOverruns) {
  LateClock clock;
  sim::RunOptions options;
  options.pace = sim::Pace::kReal;
  options.clock = &clock;
  const sim::Summary s = RunShipped("ball", {}, options);
  PrintResidual(s);
  std::cout << s.overruns << " overruns and " << s.missed_ticks << " missed of " << s.ticks << " ticks\n";
  EXPECT_EQ(s.pace, "real");
  EXPECT_EQ(clock.late_waits, 15U);
  EXPECT_EQ(s.overruns, clock.late_waits);
  EXPECT_EQ(s.missed_ticks, 3 * clock.late_waits);
  EXPECT_EQ(s.ticks + s.missed_ticks, 8000U) << "every tick is accounted for";
  EXPECT_TRUE(s.converged);
  EXPECT_LE(s.final_error_px_rms.value(), 0.5);
  EXPECT_EQ(s.frames, 240U);
  ExpectSound(s);
}

// With the computer's clock, however late it wakes the loop: counts are consistent, no limit is exceeded.
TEST(RealPace, TicksAndMissesMatchTheClock) {
  sim::RunOptions options;
  options.pace = sim::Pace::kReal;
  const sim::Summary s = RunShipped("ball", {"run.duration_s=1.5"}, options);
  std::cout << s.overruns << " overruns and " << s.missed_ticks << " missed of " << s.ticks << " ticks\n";
  EXPECT_EQ(s.pace, "real");
  EXPECT_GT(s.ticks, 0U);
  EXPECT_LE(s.ticks + s.missed_ticks, 1500U);
  EXPECT_LE(s.overruns, s.missed_ticks);
  EXPECT_GE(s.wall_time_s, 1.49) << "not faster than the clock";
  EXPECT_EQ(s.limit_violations, 0U);
}

}  // namespace
}  // namespace fovea::test
