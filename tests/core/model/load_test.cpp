// SPDX-License-Identifier: Apache-2.0
// The share of a carried load in the arm's dynamics, compared with a free body at the hand.
#include "firmware/core/model/load.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::model {
namespace {

TEST(LoadTest, LoadAddsItsWeightAndInertiaAtItsPosition) {
  const ArmModel bare = test::Panda().model;
  Load load;
  load.mass = 1.7;
  load.p_ECom = {0.03, -0.05, 0.11};
  load.I_Com_E << 4e-3, 1e-3, 0.0, 1e-3, 5e-3, -5e-4, 0.0, -5e-4, 3e-3;
  ArmModel loaded = bare;
  Attach(load, loaded);

  test::RandomStates random(31);
  double worst = 0.0;
  for (int k = 0; k < 200; ++k) {
    const VecN q = test::Ready() + random.Joints(bare, 0.5);
    const VecN dq = random.Joints(bare, 0.5);
    ArmPoses poses;
    ComputePoses(bare, q, poses);
    ArmDynamics without;
    ArmDynamics with;
    ComputeDynamics(bare, poses, dq, without);
    ComputeDynamics(loaded, poses, dq, with);

    Mat6N J;  // of the load's centre of mass, in its own axes
    const Pose X_ECom{Mat3::Identity(), load.p_ECom};
    ComputeJacobian(bare, poses, X_ECom, J);
    const Eigen::MatrixXd v = J.topRows<3>();
    const Eigen::MatrixXd w = J.bottomRows<3>();
    const Eigen::MatrixXd M = load.mass * v.transpose() * v + w.transpose() * load.I_Com_E * w;
    const Eigen::VectorXd g = -load.mass * v.transpose() * (poses.X_BE.R.transpose() * bare.g_B);
    const double off_M = (Eigen::MatrixXd(with.M) - Eigen::MatrixXd(without.M) - M).cwiseAbs().maxCoeff();
    const double off_g = (Eigen::VectorXd(with.g) - Eigen::VectorXd(without.g) - g).cwiseAbs().maxCoeff();
    ASSERT_TRUE(std::isfinite(off_M) && std::isfinite(off_g)) << with.M << without.M << M;
    worst = std::max({worst, off_M, off_g});
  }
  std::cout << "worst difference: " << worst << " [kg m^2, Nm]\n";
  EXPECT_LT(worst, 1e-12);
}

// A point mass beside the model is the same as one in it, whichever its sign.
TEST(LoadTest, PointMassBesideTheModelIsLikeOneInIt) {
  const ArmModel bare = test::Panda().model;
  const PointMass extra{0.8, Vec3(0.05, -0.03, 0.12)};
  ArmModel loaded = bare;
  Attach({extra.mass, extra.p_E, Mat3::Zero()}, loaded);
  test::RandomStates random(32);
  double worst = 0.0;
  const auto compare = [&](const ArmDynamics& a, const ArmDynamics& b) {
    worst = std::max({worst, Eigen::MatrixXd(a.M - b.M).cwiseAbs().maxCoeff(),
                      Eigen::VectorXd(a.Cdq - b.Cdq).cwiseAbs().maxCoeff(),
                      Eigen::VectorXd(a.g - b.g).cwiseAbs().maxCoeff()});
  };
  for (int k = 0; k < 200; ++k) {
    const VecN q = test::Ready() + random.Joints(bare, 0.5);
    const VecN dq = random.Joints(bare, 0.5);
    ArmPoses poses;
    ComputePoses(bare, q, poses);
    ArmDynamics without;
    ArmDynamics with;
    ComputeDynamics(bare, poses, dq, without);
    ComputeDynamics(loaded, poses, dq, with);
    ArmDynamics added = without;
    AddPointMass(bare, poses, dq, extra, added);
    compare(added, with);
    AddPointMass(bare, poses, dq, {-extra.mass, extra.p_E}, added);
    compare(added, without);
    worst = std::max(
        worst,
        Eigen::VectorXd(HoldingTorque(bare, poses, extra) - (with.g - without.g)).cwiseAbs().maxCoeff());
    ASSERT_TRUE(std::isfinite(worst));
  }
  std::cout << "worst difference: " << worst << " [kg m^2, Nm]\n";
  EXPECT_LT(worst, 1e-12);
}

}  // namespace
}  // namespace fovea::model
