// SPDX-License-Identifier: Apache-2.0
// A task in fewer rows has the same least-squares solution; compared with Eigen.
#include "firmware/core/control/compress_task.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <iostream>

#include "tests/support/random_states.hpp"

namespace fovea::control {
namespace {

using features::FeatureVector;
using features::InteractionMatrix;

TEST(CompressTaskTest, KeepsTheSolutionAndTheSingularValues) {
  test::RandomStates random(4);
  double worst = 0.0;
  double worst_gram = 0.0;
  for (int k = 0; k < 2000; ++k) {
    InteractionMatrix L(8, 6);
    FeatureVector v(8);
    for (Eigen::Index i = 0; i < 8; ++i) {
      v[i] = random.Uniform(-1.0, 1.0);
      for (Eigen::Index j = 0; j < 6; ++j) {
        L(i, j) = random.Uniform(-1.0, 1.0);
      }
    }
    const Eigen::VectorXd expected = Eigen::MatrixXd(L).colPivHouseholderQr().solve(Eigen::VectorXd(v));
    InteractionMatrix R = L;
    FeatureVector d = v;
    CompressTask(R, d);
    ASSERT_EQ(R.rows(), 6);
    ASSERT_EQ(d.size(), 6);
    const Eigen::VectorXd ours = Eigen::MatrixXd(R).colPivHouseholderQr().solve(Eigen::VectorXd(d));
    worst = std::max(worst, (ours - expected).norm() / expected.norm());
    worst_gram = std::max(worst_gram, (R.transpose() * R - L.transpose() * L).cwiseAbs().maxCoeff());
  }
  std::cout << "solution differs by " << worst << " (relative), L^T L by " << worst_gram << "\n";
  EXPECT_LT(worst, 1e-13);
  EXPECT_LT(worst_gram, 1e-14);
}

TEST(CompressTaskTest, LeavesSmallTasksUnchangedAndStaysFiniteOnSingularOnes) {
  InteractionMatrix L = InteractionMatrix::Random(6, 6);
  FeatureVector v = FeatureVector::Random(6);
  const InteractionMatrix L_before = L;
  const FeatureVector v_before = v;
  CompressTask(L, v);
  EXPECT_EQ(L, L_before);
  EXPECT_EQ(v, v_before);

  InteractionMatrix zero = InteractionMatrix::Zero(8, 6);
  FeatureVector w = FeatureVector::Ones(8);
  CompressTask(zero, w);
  EXPECT_EQ(zero, InteractionMatrix::Zero(6, 6));
  EXPECT_TRUE(w.allFinite());

  InteractionMatrix twice(8, 6);  // every column the same
  twice.colwise() = FeatureVector::LinSpaced(8, 1.0, 2.0);
  const double norm = twice.norm();
  CompressTask(twice, w);
  EXPECT_TRUE(twice.allFinite());
  EXPECT_NEAR(twice.norm(), norm, 1e-14);
}

}  // namespace
}  // namespace fovea::control
