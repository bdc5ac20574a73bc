// SPDX-License-Identifier: Apache-2.0
// Linear systems of any order, compared with closed-form responses.
#include "firmware/host/design/linear_system.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "tests/host/design/plants.hpp"

namespace fovea::design {
namespace {

TEST(LinearSystemTest, ResponseMatchesTheSecondOrderSystem) {
  std::mt19937 random(21);
  double worst = 0.0;
  for (int i = 0; i < 200; ++i) {
    const SecondOrder plant = test::RandomPlant(random);
    // The third state is the constant force.
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    A(0, 1) = 1.0;
    A.row(1) << -plant.stiffness / plant.mass, -plant.damping / plant.mass, 1.0 / plant.mass;
    const double t = test::LogUniform(random, 1e-3, 1.0);
    const Eigen::VectorXd x = LinearResponse(A, Eigen::Vector3d(1.0, -2.0, 5.0), t);
    const double size = 1.0 + A.norm();
    worst = std::fmax(worst, std::fabs(x[0] - Response(plant, 1.0, -2.0, 5.0, t)) / size);
    worst = std::fmax(worst, std::fabs(x[1] - ResponseVelocity(plant, 1.0, -2.0, 5.0, t)) / size);
  }
  std::cout << "worst difference between matrix exponential and closed form: " << worst << "\n";
  EXPECT_LT(worst, 1e-13);
}

// (s + 1)(s + 2)(s + 3): e = 3 exp(-t) - 3 exp(-2t) + exp(-3t) from e(0) = 1 at rest.
TEST(LinearSystemTest, IntegralLoopHasItsKnownPolesAndResponse) {
  const Eigen::Matrix3d A = IntegralLoop(11.0, 6.0, 6.0);
  const std::vector<std::complex<double>> poles = Poles(A);
  ASSERT_EQ(poles.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(std::abs(poles[static_cast<std::size_t>(i)] + (1.0 + i)), 0.0, 1e-12);
  }
  for (const double t : {0.0, 0.1, 1.0, 4.0}) {
    const double e = 3.0 * std::exp(-t) - 3.0 * std::exp(-2.0 * t) + std::exp(-3.0 * t);
    EXPECT_NEAR(LinearResponse(A, Eigen::Vector3d(1.0, 0.0, 0.0), t)[0], e, 1e-13);
  }
}

// Routh: stable while k_i < k_v k_p.
TEST(LinearSystemTest, IntegralLoopIsStableUpToTheRouthLimit) {
  EXPECT_LT(Poles(IntegralLoop(3.0, 2.0, 0.999 * 6.0)).front().real(), 0.0);
  EXPECT_GT(Poles(IntegralLoop(3.0, 2.0, 1.001 * 6.0)).front().real(), 0.0);
  EXPECT_NEAR(Poles(IntegralLoop(3.0, 2.0, 6.0)).front().imag(), std::sqrt(3.0), 1e-12);
}

}  // namespace
}  // namespace fovea::design
