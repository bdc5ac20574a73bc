// SPDX-License-Identifier: Apache-2.0
// Measurements that must not be used for steering.
#include "firmware/core/estimate/eye_watch.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iostream>

#include "firmware/core/model/types.hpp"

namespace fovea::estimate {
namespace {

using model::Vec3;

// The camera moves along x at `hand(t)` [m/s] over a target at `target(t)` [m], which it measures through
// `eye`. Returns the way until the watch doubts the measurements [m], or -1.
template <class Hand, class Target, class Eye>
double WayUntilDoubted(double duration_s, const Hand& hand, const Target& target, const Eye& eye) {
  const config::PredictConfig config;
  EyeWatch watch;
  double x = 0.0;
  double way = 0.0;
  for (int k = 0; k < static_cast<int>(30.0 * duration_s); ++k) {
    const double t = k / 30.0;
    x += hand(t) / 30.0;
    way += std::fabs(hand(t)) / 30.0;
    const model::Pose X_BC{model::Mat3::Identity(), {x, 0.0, 0.0}};
    WatchPicture(config, X_BC, eye(X_BC.Inverse() * Vec3(target(t), 0.02, 0.5)), watch);
    if (watch.doubted) {
      return way;
    }
  }
  return -1.0;
}

const auto kTrue = [](const Vec3& p) { return p; };
const auto kStill = [](double) { return 0.1; };

TEST(EyeWatchTest, MirroredPictureIsDoubted) {
  const double way = WayUntilDoubted(
      5.0, [](double) { return 0.3; }, kStill, [](const Vec3& p) { return Vec3(-p.x(), p.y(), p.z()); });
  std::cout << "after " << 1e3 * way << " mm\n";
  EXPECT_GT(way, 0.0);
  EXPECT_LT(way, 0.2);
}

// The camera is turned about its axis against its mount. Up to 45 degrees the servo gets there all the same.
TEST(EyeWatchTest, TurnedPictureIsDoubtedBeforeSteeringLeadsAway) {
  for (const double deg : {-170.0, -90.0, -65.0, -45.0, 0.0, 30.0, 45.0, 65.0, 90.0, 135.0, 180.0}) {
    const double way = WayUntilDoubted(
        5.0, [](double) { return 0.3; }, kStill,
        [deg](const Vec3& p) -> Vec3 { return Eigen::AngleAxisd(deg / 57.29577951, Vec3::UnitZ()) * p; });
    std::cout << deg << " degrees: after " << 1e3 * way << " mm\n";
    EXPECT_EQ(way > 0.0, std::fabs(deg) > 60.0) << deg;
    EXPECT_LT(way, 0.2) << deg;
  }
}

// The camera turns about its axis while it moves a little, and its pictures are 10 ms older than believed.
TEST(EyeWatchTest, WrongStampsOfATurningCameraAreNoTurnedPicture) {
  const config::PredictConfig config;
  EyeWatch watch;
  const auto camera_at = [](double t) {
    const double way = t * t;  // from rest
    return model::Pose{Eigen::AngleAxisd(2.0 * way, Vec3::UnitZ()).toRotationMatrix(),
                       {0.03 * way, 0.0, 0.0}};
  };
  for (int k = 0; k < 15; ++k) {
    const double t = k / 30.0;
    const Vec3 seen = camera_at(std::max(t - 0.01, 0.0)).Inverse() * Vec3(0.1, 0.1, 0.5);
    WatchPicture(config, camera_at(t), seen, watch);
    EXPECT_FALSE(watch.suspected) << k;
  }
  EXPECT_FALSE(watch.doubted);
}

// Targets that move on their own, while the hand follows up to 0.16 s behind.
TEST(EyeWatchTest, MovingTargetsAreNotTurnedPictures) {
  const config::PredictConfig config;
  int doubted = 0;
  for (int run = 0; run < 64; ++run) {
    EyeWatch watch;
    const double rate = 0.5 + 0.05 * run;
    const double behind = 0.04 * (run % 5);
    const auto target = [&](double t) {
      return Vec3(0.1 * std::cos(rate * t), 0.1 * std::sin(rate * t), 0.5);
    };
    for (int k = 0; k < 600; ++k) {
      const double t = k / 30.0;
      Vec3 hand = target(t - behind);
      hand.z() = 0.0;
      const model::Pose X_BC{model::Mat3::Identity(), hand};
      WatchPicture(config, X_BC, X_BC.Inverse() * target(t), watch);
    }
    doubted += watch.doubted ? 1 : 0;
  }
  EXPECT_EQ(doubted, 0);
}

TEST(EyeWatchTest, RestingOrTrackedTargetIsNotDoubted) {
  EXPECT_EQ(WayUntilDoubted(
                20.0, [](double t) { return 0.4 * std::sin(3.0 * t); }, kStill, kTrue),
            -1.0);
  // Tracked to and fro, 0.1 s behind.
  EXPECT_EQ(WayUntilDoubted(
                20.0, [](double t) { return 0.2 * std::cos(2.0 * (t - 0.1)); },
                [](double t) { return 0.1 * std::sin(2.0 * t); }, kTrue),
            -1.0);
  // From rest, the hand reaches the target's speed in half a second.
  EXPECT_EQ(WayUntilDoubted(
                5.0, [](double t) { return 0.3 * std::min(1.0, 2.0 * t); }, [](double t) { return 0.3 * t; },
                kTrue),
            -1.0);
}

TEST(EyeWatchTest, SteeringThatDoesNotReduceTheErrorIsDoubted) {
  const config::PredictConfig config;
  EyeWatch watch;
  double way = 0.0;
  while (!watch.doubted && way < 10.0) {
    way += 0.5e-3;
    WatchSteering(config, 0.6 + 0.1 * std::sin(10.0 * way), 0.5, watch);
  }
  std::cout << "after " << way << " m\n";
  EXPECT_LT(way, 1.5);
  // An error that falls, then one that stays small while a target is tracked for long.
  EyeWatch sound;
  for (int tick = 0; tick < 4000; ++tick) {
    WatchSteering(config, std::exp(-1e-3 * tick), 0.5, sound);
  }
  for (int tick = 0; tick < 100'000; ++tick) {
    WatchSteering(config, 0.1, 0.5, sound);
  }
  EXPECT_FALSE(sound.doubted);
}

}  // namespace
}  // namespace fovea::estimate
