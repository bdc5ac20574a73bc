// SPDX-License-Identifier: Apache-2.0
// Rotation vectors, matrices and quaternions: round trips from tiny angles to half a turn.
#include "firmware/core/model/rotation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <random>

namespace fovea::model {
namespace {

TEST(RotationTest, MatchesEigenAndRoundTrips) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double worst_matrix = 0.0;
  double worst_back = 0.0;
  double worst_quaternion = 0.0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 axis = Vec3(normal(random), normal(random), normal(random)).normalized();
    // Angles of every size, with many near zero and near half a turn.
    const double u = std::uniform_real_distribution<double>(-9.0, 0.0)(random);
    const double angle = n % 3 == 0   ? std::pow(10.0, u)
                         : n % 3 == 1 ? M_PI - std::pow(10.0, u)
                                      : -u / 9.0 * M_PI;
    const Vec3 phi = angle * axis;
    const Mat3 truth = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const Mat3 R = RotationOf(phi);
    worst_matrix = std::max(worst_matrix, (R - truth).cwiseAbs().maxCoeff());
    worst_back = std::max(worst_back, (RotationVector(R) - phi).norm());
    const std::array<double, 4> q = QuaternionOf(truth);
    const Eigen::Quaterniond q_truth(truth);
    EXPECT_GE(q[0], 0.0);
    const double dot = q[0] * q_truth.w() + q[1] * q_truth.x() + q[2] * q_truth.y() + q[3] * q_truth.z();
    worst_quaternion = std::max(worst_quaternion, std::fabs(std::fabs(dot) - 1.0));
    Mat3 again;
    ASSERT_TRUE(RotationOfQuaternion(q, again));
    worst_quaternion = std::max(worst_quaternion, (again - truth).cwiseAbs().maxCoeff());
  }
  std::cout << "matrices differ by " << worst_matrix << ", vectors after a round trip by " << worst_back
            << " rad, quaternions by " << worst_quaternion << "\n";
  EXPECT_LT(worst_quaternion, 1e-14);
  EXPECT_LT(worst_matrix, 1e-14);
  EXPECT_LT(worst_back, 1e-12);
  EXPECT_EQ(RotationVector(Mat3::Identity()).norm(), 0.0);
}

TEST(RotationTest, RotationVectorRatesMatchFiniteDifferences) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  const double h = 1e-6;
  double worst = 0.0;
  double worst_inverse = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const double size = std::pow(10.0, std::uniform_real_distribution<double>(-6.0, 0.45)(random));
    const Vec3 phi = size * Vec3(normal(random), normal(random), normal(random)).normalized();
    const Vec3 rate(normal(random), normal(random), normal(random));
    const Mat3 change = RotationOf(phi + h * rate) * RotationOf(phi - h * rate).transpose();
    const Vec3 w = RotationVector(change) / (2.0 * h);
    worst = std::max(worst, (TurnRateMatrix(phi) * rate - w).norm());
    worst_inverse =
        std::max(worst_inverse, (TurnRateInverse(phi) * TurnRateMatrix(phi) - Mat3::Identity()).norm());
  }
  std::cout << "rates off by " << worst << " rad/s; inverse by " << worst_inverse << "\n";
  EXPECT_LT(worst, 1e-8);
  EXPECT_LT(worst_inverse, 1e-11);
}

}  // namespace
}  // namespace fovea::model
