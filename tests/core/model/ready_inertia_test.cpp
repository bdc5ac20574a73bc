// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/ready_inertia.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <iostream>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/load.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::model {
namespace {

TEST(InertiaAtReady, MatchesTheInverseOfTheMassMatrixWithAnyLoad) {
  test::RandomStates random(71);
  double worst = 0.0;
  double closest = 0.0;
  for (int k = 0; k < 100; ++k) {
    ArmModel arm = test::Panda().model;
    Attach({random.Uniform(0.0, 10.0), random.Vector(0.4), Mat3::Identity() * 1e-3}, arm);
    ArmPoses poses;
    ArmDynamics dynamics;
    ComputePoses(arm, test::Ready(), poses);
    ComputeDynamics(arm, poses, VecN::Zero(7), dynamics);
    const Eigen::MatrixXd M = dynamics.M;
    const Eigen::VectorXd coupling = M.diagonal().cwiseProduct(M.inverse().diagonal());
    const ReadyInertia ready = InertiaAtReady(arm);
    EXPECT_EQ(ready.held, dynamics.M.diagonal());
    worst = std::max(
        worst, (Eigen::VectorXd(ready.coupling).cwiseQuotient(coupling).array() - 1.0).abs().maxCoeff());
    EXPECT_GE(ready.coupling.minCoeff(), 1.0);
    closest = std::max(closest, ready.coupling.maxCoeff());
  }
  std::cout << "coupled up to " << closest << " times; off by at most " << worst << '\n';
  EXPECT_LT(worst, 1e-10);
}

}  // namespace
}  // namespace fovea::model
