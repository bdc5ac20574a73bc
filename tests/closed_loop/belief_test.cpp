// SPDX-License-Identifier: Apache-2.0
// The servo's assumptions are wrong: false measurements, encoders that hang, unknown loads.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>

#include "tests/closed_loop/adversary_run.hpp"
#include "tests/closed_loop/guard_bench.hpp"

namespace fovea::test {
namespace {

using hal::Fault;
using hal::Mode;

constexpr double kOnsetS = 0.6;  // on the way to the goal

GuardSetup Tracking() {
  GuardSetup setup;
  setup.servo.auto_track = true;
  setup.servo.guard.obstacles.num_planes = 1;
  setup.servo.guard.obstacles.planes[0] = {model::Vec3::UnitZ(), 0.01};
  setup.target = [](double) { return Eigen::Vector3d(0.55, 0.1, 0.04); };
  return setup;
}

double WayOfHand(const GuardBench& bench, const Eigen::Vector3d& from) {
  return (bench.truth().X_BE.translation() - from).norm();
}

// The picture freezes on the way to the goal, with fresh noise and fresh stamps, for a while or for good.
TEST(SensorFault, FrozenPictureStopsTheArm) {
  for (const double lasts_s : {0.2, 1.0, 5.0, 100.0}) {
    GuardSetup setup = Tracking();
    hal::FeatureMeasurement frozen;
    std::mt19937_64 random(5);
    std::normal_distribution<double> noise(0.0, 1e-3);
    setup.spoil = [&](hal::FeatureMeasurement& m) {
      const double t_s = 1e-9 * static_cast<double>(m.stamp_ns);
      if (t_s < kOnsetS || t_s >= kOnsetS + lasts_s) {
        return;
      }
      frozen = frozen.found ? frozen : m;
      m.s = frozen.s;
      for (std::size_t i = 0; i < 3; ++i) {
        m.s[i] += noise(random);
      }
      m.same_for_ns = m.stamp_ns - frozen.stamp_ns;
    };
    GuardBench bench(setup);
    bench.RunUntil(kOnsetS);
    const Eigen::Vector3d before = bench.truth().X_BE.translation();
    bench.RunUntil(kOnsetS + 3.0);
    const double way = WayOfHand(bench, before);
    PrintFigures(fmt::format("frozen for {} s: {:.0f} mm in 3 s", lasts_s, 1e3 * way), bench);
    ExpectInsideLimits(bench);
    EXPECT_FALSE(bench.truth().contacts.Any());
    EXPECT_EQ(bench.FirstFault(), -1);
    bench.RunUntil(kOnsetS + 6.0);
    if (lasts_s > 10.0) {
      EXPECT_EQ(bench.last().record.mode, Mode::kHold);
      EXPECT_LT(bench.speeds().back(), 0.01);
      EXPECT_LT(way, 0.25);
    } else if (lasts_s < 2.0) {
      const Eigen::Vector3d p = bench.truth().X_BC.inverse() * Eigen::Vector3d(0.55, 0.1, 0.04);
      EXPECT_LT((p - Eigen::Vector3d(0.0, 0.0, 0.4)).norm(), 5e-3) << "the arm goes on to its goal";
    }
  }
}

// All encoders, or one, hang: stamps go on, velocities read zero.
TEST(SensorFault, AllEncodersStuckRaisesAFault) {
  for (const int joint : {-1, 0, 1, 3, 5}) {
    GuardSetup setup = Tracking();
    setup.arm_faults.stuck = {{kOnsetS, 100.0}, joint};
    GuardBench bench(setup);
    bench.RunUntil(kOnsetS);
    const Eigen::Vector3d before = bench.truth().X_BE.translation();
    bench.RunUntil(kOnsetS + 2.0);
    const int ticks = bench.FirstFault() - static_cast<int>(1e3 * kOnsetS);
    PrintFigures(fmt::format("joint {}: {} after {} ticks, {:.0f} mm", joint + 1,
                             hal::Name(bench.last().record.fault), ticks, 1e3 * WayOfHand(bench, before)),
                 bench);
    ASSERT_NE(bench.FirstFault(), -1);
    EXPECT_LE(ticks, 60);
    EXPECT_TRUE(bench.last().record.command.engage_brakes);
    EXPECT_LE(bench.figures().velocity, 1.0);
    EXPECT_LT(WayOfHand(bench, before), 0.08);
  }
}

// Encoders with coarse steps, under an unknown load: a joint reads the same for a while although it is sound.
TEST(SensorFault, QuantisedEncodersUnderLoadRaiseNoFault) {
  for (const double load : {0.0, 0.3, 1.0}) {
    GuardSetup setup = Tracking();
    setup.world.encoder_noise = 0.0;
    setup.world.encoder_quantum = 1e-4;
    setup.world.load = {{0.0, 100.0}, load};
    GuardBench bench(setup);
    bench.RunUntil(6.0);
    const Eigen::Vector3d p = bench.truth().X_BC.inverse() * Eigen::Vector3d(0.55, 0.1, 0.04);
    std::cout << load << " kg: " << hal::Name(bench.last().record.fault) << ", "
              << 1e3 * (p - Eigen::Vector3d(0.0, 0.0, 0.4)).norm() << " mm from the goal\n";
    EXPECT_EQ(bench.FirstFault(), -1);
    EXPECT_LT((p - Eigen::Vector3d(0.0, 0.0, 0.4)).norm(), 5e-3);
  }
}

// From the first state on, the servo holds the arm where it is, whatever load it carries.
TEST(SensorFault, BootHoldsTheArmUnderAnUnknownLoad) {
  for (const double load : {0.0, 0.3, 0.7, 1.5, 3.0}) {
    GuardSetup setup;
    setup.world.load = {{0.0, 100.0}, load};
    GuardBench bench(setup);
    const Eigen::Vector3d before = bench.truth().X_BE.translation();
    double furthest = 0.0;
    for (int ms = 1; ms <= 1000; ++ms) {
      bench.RunUntil(1e-3 * ms);
      furthest = std::max(furthest, WayOfHand(bench, before));
    }
    PrintFigures(fmt::format("{} kg: at most {:.1f} mm, {} {}", load, 1e3 * furthest,
                             hal::Name(bench.last().record.mode), hal::Name(bench.last().record.fault)),
                 bench);
    EXPECT_LT(furthest, 0.002 + 0.012 * load);
    EXPECT_LE(bench.figures().velocity, load < 2.0 ? 0.2 : 0.6) << "a load of 3 kg counts as a push";
  }
}

// A fault cancels the request to track: after recovery the arm moves only when asked again.
TEST(SensorFault, AfterAFaultNothingMovesUntilTrackIsRequested) {
  GuardSetup setup = Tracking();
  setup.arm_faults.packet_loss = {{kOnsetS, kOnsetS + 0.1}, 1.0};
  GuardBench bench(setup);
  bench.RunUntil(2.5);
  ASSERT_EQ(bench.last().record.mode, Mode::kFault);
  const Eigen::Vector3d before = bench.truth().X_BE.translation();
  bench.Ask(task::Request::kReset);
  bench.RunUntil(4.5);
  EXPECT_EQ(bench.last().record.mode, Mode::kHold);
  std::cout << 1e3 * WayOfHand(bench, before) << " mm within 2 s of the recovery\n";
  EXPECT_LT(WayOfHand(bench, before), 1e-3);
  bench.Ask(task::Request::kTrack);
  bench.RunUntil(9.0);
  EXPECT_EQ(bench.last().record.mode, Mode::kTrack);
}

// No stream of measurements leads past a limit, into the table or the arm itself, or to a fault. A longer
// run: fovea-adversary --hours 10.
TEST(SensorFault, AdversarialMeasurementsExceedNoLimit) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    const AdversaryFigures figures = RunAdversary(120.0, seed, {});
    std::cout << InWords(figures);
    EXPECT_TRUE(figures.Sound());
    EXPECT_GT(figures.tracking_ticks, 20'000) << "too little tracking to be misled";
    EXPECT_LE(figures.fastest_target, 1.0 + 1e-9);
  }
}

}  // namespace
}  // namespace fovea::test
