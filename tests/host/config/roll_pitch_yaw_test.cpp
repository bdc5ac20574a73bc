// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/config/roll_pitch_yaw.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <iostream>
#include <random>

namespace fovea::config {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

TEST(RollPitchYaw, TurnsAboutFixedAxesInThisOrder) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> angle(-180.0, 180.0);
  for (int k = 0; k < 200; ++k) {
    const std::vector<double> rpy{angle(engine), angle(engine), angle(engine)};
    const Eigen::Matrix3d expected = (Eigen::AngleAxisd(kRadPerDeg * rpy[2], Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(kRadPerDeg * rpy[1], Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(kRadPerDeg * rpy[0], Eigen::Vector3d::UnitX()))
                                         .toRotationMatrix();
    EXPECT_LT((RollPitchYaw(rpy) - expected).norm(), 1e-14);
  }
}

TEST(RollPitchYaw, AnglesOfARotationGiveTheRotationBack) {
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> angle(-180.0, 180.0);
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    // Every fourth pitch is +-90 degrees, exactly or within a millionth of a degree.
    const double upright = (k % 8 == 0 ? 90.0 : -90.0) + (k % 16 < 8 ? 0.0 : 1e-6);
    const std::vector<double> rpy{angle(engine), k % 4 == 0 ? upright : angle(engine), angle(engine)};
    const model::Mat3 R = RollPitchYaw(rpy);
    const std::array<double, 3> back = RollPitchYawOf(R);
    EXPECT_LE(std::abs(back[1]), 90.0);
    worst = std::max(worst, (RollPitchYaw({back.begin(), back.end()}) - R).norm());
  }
  std::cout << "off by at most " << worst << '\n';
  EXPECT_LT(worst, 1e-12);
}

TEST(RollPitchYaw, AnglesWithinTheirRangesRoundTrip) {
  for (const std::array<double, 3>& rpy : {std::array<double, 3>{0.0, 0.0, 0.0},
                                           {10.0, -20.0, 30.0},
                                           {-170.0, 89.0, 179.0},
                                           {0.0, 0.0, -90.0}}) {
    const std::array<double, 3> back = RollPitchYawOf(RollPitchYaw({rpy.begin(), rpy.end()}));
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(back[k], rpy[k], 1e-9);
    }
  }
}

}  // namespace
}  // namespace fovea::config
