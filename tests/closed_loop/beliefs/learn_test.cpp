// SPDX-License-Identifier: Apache-2.0
// servo.learn in whole runs: what is believed wrongly is found out, and applied while the arm moves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "firmware/host/recording/flight/replay.hpp"
#include "tests/closed_loop/closed_loop.hpp"

namespace fovea::test {
namespace {

std::vector<std::string> Joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// The tracking error of `ball-moving` from 4 s to 8 s [px rms]; none if the ball is lost.
std::optional<double> TrackingError(const std::string& seed, const std::vector<std::string>& more) {
  const sim::Summary s = RunShipped("ball-moving", Joined({seed, "run.duration_s=8"}, more));
  ExpectSound(s);
  for (const beliefs::Correction& correction : s.beliefs.value().learnt) {
    fmt::print("  {}\n", correction.text);
  }
  return LastMode(s) == "track" ? s.tracking_error_px_rms : std::nullopt;
}

// The servo's filter finds an error of 20 ms by itself as soon as the camera moves. Learning must not spoil
// that. An older picture costs some accuracy, even where the servo knows its age.
TEST(Learn, WrongLatencyOfAMovingTarget) {
  for (const char* seed : {"run.seed=1", "run.seed=2"}) {
    const double right = TrackingError(seed, {}).value();
    for (const char* truth : {"truth.camera.latency_ms=60", "truth.camera.latency_ms=20"}) {
      const double learns = TrackingError(seed, {truth, "servo.learn=latency"}).value();
      fmt::print("{} {}: {:.3f} px rms, with right beliefs {:.3f}\n", seed, truth, learns, right);
      EXPECT_LT(std::fabs(learns - right), 0.5);
    }
  }
}

// 50 ms are beyond what the filter believes: without learning the ball is lost.
TEST(Learn, FindsALatencyBeyondTheFiltersRange) {
  const std::vector<std::string> truth = {"truth.camera.latency_ms=90"};
  EXPECT_FALSE(TrackingError("run.seed=1", truth));
  const std::optional<double> learns = TrackingError("run.seed=1", Joined(truth, {"servo.learn=latency"}));
  const std::optional<double> known = TrackingError("run.seed=1", {"camera.latency_ms=90"});
  ASSERT_TRUE(learns && known);
  fmt::print("{:.3f} px rms; with 90 ms configured {:.3f}\n", *learns, *known);
  EXPECT_LT(std::fabs(*learns - *known), 0.5);
}

struct Followed {
  double off_rad = 0.0;  // rms of the joints' deviation from their reference, over the last 4 s
  double torque = 0.0;   // rms of the observed external torques over that time [Nm]
  sim::Summary summary;
};

Followed Exciting(const std::vector<std::string>& more) {
  Followed followed;
  double off2 = 0.0;
  double torque2 = 0.0;
  int count = 0;
  sim::RunOptions options;
  options.observer.on_record = [&](const hal::TickRecord& r) {
    if (r.stamp_ns < 4 * hal::kNsPerSecond) {
      return;
    }
    for (std::size_t i = 0; i < 7; ++i) {
      off2 += std::pow(r.q_cmd[i] - r.arm.q[i], 2);
      torque2 += std::pow(r.tau_ext[i], 2);
    }
    ++count;
  };
  followed.summary = RunShipped("ball-exciting", Joined({"run.seed=1"}, more), options);
  ExpectSound(followed.summary);
  followed.off_rad = std::sqrt(off2 / count);
  followed.torque = std::sqrt(torque2 / count);
  return followed;
}

TEST(Learn, PayloadThatIsHeavierThanBelieved) {
  // Of the errors that the scenario draws of the arm's torques, the load alone.
  const std::vector<std::string> heavier = {"truth.arm.load_mass.range=[0.3,0.3]",
                                            "truth.arm.link_mass.scale_sigma=0",
                                            "truth.arm.torque_bias.sigma=[0,0,0,0,0,0,0]"};
  const Followed without = Exciting(heavier);
  const Followed learns = Exciting(Joined(heavier, {"servo.learn=payload"}));
  fmt::print("external torque {:.3f} Nm rms, without learning {:.3f}; joints off by {:.5f} rad rms, {:.5f}\n",
             learns.torque, without.torque, learns.off_rad, without.off_rad);
  ASSERT_FALSE(learns.summary.beliefs->learnt.empty());
  for (const beliefs::Correction& correction : learns.summary.beliefs->learnt) {
    fmt::print("  {}\n", correction.text);
  }
  EXPECT_NEAR(learns.summary.beliefs->learnt.back().to, 0.3, 0.05);
  EXPECT_LT(learns.torque, 0.2 * without.torque);
  EXPECT_LT(learns.off_rad, 0.5 * without.off_rad);
}

// Right beliefs stay as they are, so the run is the one without learning, to the last bit.
TEST(Learn, NothingOfRightBeliefs) {
  const sim::Summary without = RunShipped("ball");
  const sim::Summary learns = RunShipped("ball", {"servo.learn=latency,payload"});
  EXPECT_TRUE(learns.beliefs.value().learnt.empty());
  EXPECT_EQ(learns.log_hash, without.log_hash);
}

// What is learnt is an input of the tick: a run can be repeated, and replayed from its log.
TEST(Learn, RunsAreReproducibleAndReplayable) {
  const std::filesystem::path out = std::filesystem::path(testing::TempDir()) / "fovea_learn_test";
  const std::vector<std::string> settings = {"run.seed=1", "run.duration_s=4", "servo.learn=latency, payload",
                                             "truth.arm.load_mass.range=[0.3,0.3]",
                                             "truth.camera.latency_ms=60"};
  const sim::Summary first = RunShipped("ball-moving", settings);
  sim::RunOptions options;
  options.out = out;
  options.show_progress = false;
  const sim::Summary second = sim::RunScenario(sim::LoadScenario("ball-moving", settings), options);
  EXPECT_EQ(first.log_hash, second.log_hash);
  EXPECT_GE(second.beliefs.value().learnt.size(), 2U);
  const flight::ReplayResult replay = flight::Replay(out / "log.mcap", {});
  fmt::print("{} ticks replayed\n", replay.ticks());
  EXPECT_GT(replay.ticks(), 3000U);
  EXPECT_TRUE(replay.Identical());
  std::filesystem::remove_all(out);
}

TEST(Learn, UnknownWordIsRefused) {
  try {
    RunShipped("ball", {"servo.learn=latncy"});
    FAIL() << "it was allowed";
  } catch (const std::exception& error) {
    EXPECT_EQ(std::string(error.what()),
              "servo.learn = \"latncy\" is not allowed: \"latncy\" is none of latency, payload, separated by "
              "commas; did you mean latency?");
  }
}

}  // namespace
}  // namespace fovea::test
