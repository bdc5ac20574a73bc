// SPDX-License-Identifier: Apache-2.0
// Shortcuts of the kinematics against the general formulas, to the last bit.
#include "firmware/core/model/kinematics.hpp"

#include <gtest/gtest.h>

#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/math.hpp"
#include "firmware/core/model/rotation.hpp"
#include "tests/support/panda.hpp"
#include "tests/support/random_states.hpp"

namespace fovea::model {
namespace {

// The arm with each joint's frame turned about `phi`, so that no joint turns about x.
ArmModel Tilted(ArmModel arm, const Vec3& phi) {
  for (Joint& joint : arm.joints) {
    joint.X_PJ.R = joint.X_PJ.R * RotationOf(phi);
  }
  return arm;
}

// Every product written out.
Pose EndByProducts(const ArmModel& arm, const VecN& q) {
  Pose X_BL;
  for (int i = 0; i < arm.num_joints; ++i) {
    const Pose& X_PJ = arm.joints[static_cast<std::size_t>(i)].X_PJ;
    Pose X_BJ;
    X_BJ.R = X_BL.R.lazyProduct(X_PJ.R);
    X_BJ.p = X_BL.p + X_BL.R.lazyProduct(X_PJ.p);
    const auto [s, c] = SinCos(q[i]);
    X_BL = X_BJ;
    X_BL.R.col(0) = c * X_BJ.R.col(0) + s * X_BJ.R.col(1);
    X_BL.R.col(1) = c * X_BJ.R.col(1) - s * X_BJ.R.col(0);
  }
  return X_BL * arm.X_LnE;
}

TEST(KinematicsTest, TurnsAboutXHaveTheSamePosesAsAllProducts) {
  const ArmModel panda = test::PandaConfig().arm;
  test::RandomStates random(11);
  for (const ArmModel& arm : {panda, Tilted(panda, {0.0, 0.3, 0.0}), Tilted(panda, {0.2, 0.0, 0.0})}) {
    for (int k = 0; k < 200; ++k) {
      const VecN q = random.Joints(arm, 0.9);
      ArmPoses poses;
      ComputePoses(arm, q, poses);
      const Pose expected = EndByProducts(arm, q);
      EXPECT_EQ(poses.X_BE.R, expected.R);
      EXPECT_EQ(poses.X_BE.p, expected.p);
    }
  }
}

TEST(KinematicsTest, TheVelocityOfAPointIsThatOfItsJacobian) {
  const ArmModel arm = test::PandaConfig().arm;
  test::RandomStates random(12);
  for (int k = 0; k < 200; ++k) {
    ArmPoses poses;
    ComputePoses(arm, random.Joints(arm, 0.9), poses);
    const VecN dq = random.Joints(arm, 0.5);
    const Vec3 p_B = poses.X_BE.p + Vec3(random.Uniform(-0.2, 0.2), 0.1, random.Uniform(-0.2, 0.2));
    LinearJacobian J;
    ComputeLinearJacobian(arm, poses, p_B, J);
    EXPECT_EQ(LinearVelocity(arm, poses, p_B, dq), J.lazyProduct(dq));
    for (int i = 0; i < arm.num_joints; ++i) {
      EXPECT_EQ(PointVelocity(arm, poses, i, p_B), J.col(i));
    }
  }
}

TEST(CholeskyTest, ColumnsSolvedTogetherAreThoseSolvedAlone) {
  test::RandomStates random(13);
  Eigen::Matrix<double, 8, 8> B;
  Eigen::Matrix<double, 8, 7> together;
  for (Eigen::Index i = 0; i < 8; ++i) {
    for (Eigen::Index j = 0; j < 8; ++j) {
      B(i, j) = random.Uniform(-1.0, 1.0);
    }
    for (Eigen::Index j = 0; j < 7; ++j) {
      together(i, j) = random.Uniform(-1.0, 1.0);
    }
  }
  Eigen::Matrix<double, 8, 8> L = B.lazyProduct(B.transpose());
  FactorCholesky(L);
  const Eigen::Matrix<double, 8, 7> wanted = together;
  SolveCholesky(L, together);
  for (Eigen::Index j = 0; j < 7; ++j) {
    Eigen::Matrix<double, 8, 1> alone = wanted.col(j);
    SolveCholesky(L, alone);
    EXPECT_EQ(together.col(j), alone) << "column " << j;
    EXPECT_LT((B.lazyProduct(B.transpose()).lazyProduct(alone) - wanted.col(j)).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace fovea::model
