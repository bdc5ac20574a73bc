// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/friction_impulse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "tests/support/random_states.hpp"

namespace fovea::sim {
namespace {

// Each impulse is at its bound against the speed, or smaller while the joint rests.
TEST(FrictionImpulseTest, HoldsOrSlides) {
  test::RandomStates random(9);
  int held = 0;
  int slid = 0;
  for (int k = 0; k < 300; ++k) {
    Eigen::MatrixXd L(5, 5);
    Eigen::VectorXd v(5), most(5);
    for (Eigen::Index i = 0; i < 5; ++i) {
      for (Eigen::Index j = 0; j < 5; ++j) {
        L(i, j) = random.Uniform(-1.0, 1.0);
      }
      v[i] = random.Uniform(-1.0, 1.0);
      most[i] = random.Uniform(0.0, 0.8);
    }
    const Eigen::MatrixXd W = L * L.transpose() + 0.3 * Eigen::MatrixXd::Identity(5, 5);
    const Eigen::VectorXd j = FrictionImpulse(W, v, most);
    const Eigen::VectorXd after = v + W * j;
    for (Eigen::Index i = 0; i < 5; ++i) {
      ASSERT_LE(std::fabs(j[i]), most[i]);
      if (std::fabs(j[i]) < most[i]) {
        EXPECT_LT(std::fabs(after[i]), 1e-12);
        ++held;
      } else {
        EXPECT_LE(after[i] * j[i], 1e-12);
        ++slid;
      }
    }
  }
  std::cout << held << " joints rest, " << slid << " slide\n";
  EXPECT_GT(held, 100);
  EXPECT_GT(slid, 100);
}

}  // namespace
}  // namespace fovea::sim
