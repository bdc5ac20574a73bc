// SPDX-License-Identifier: Apache-2.0
// The quadratic program against its optimality conditions, and against another method.
#include "firmware/planning/horizon_program.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "tests/support/random_states.hpp"

namespace fovea::planning {
namespace {

constexpr int kSize = 12;

Eigen::MatrixXd Random(test::RandomStates& random, int rows, int columns) {
  Eigen::MatrixXd m(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      m(i, j) = random.Uniform(-1.0, 1.0);
    }
  }
  return m;
}

void Set(test::RandomStates& random, HorizonProgram& program) {
  const Eigen::MatrixXd root = Random(random, kSize, kSize);
  program.Clear();
  program.H() = root.transpose() * root + 0.05 * Eigen::MatrixXd::Identity(kSize, kSize);
  program.g() = Random(random, kSize, 1);
}

TEST(HorizonProgram, WithoutRowsTheSolutionIsExact) {
  test::RandomStates random(1);
  HorizonProgram program(kSize, 1);
  for (int k = 0; k < 50; ++k) {
    Set(random, program);
    const Eigen::VectorXd x = program.Solve();
    EXPECT_LT((program.H() * x + program.g()).norm(), 1e-6);
  }
}

// Boxes: projected gradient descent finds the same point.
TEST(HorizonProgram, BoxesAgreeWithProjectedGradients) {
  test::RandomStates random(2);
  HorizonProgram program(kSize, kSize);
  double worst = 0.0;
  int active = 0;
  for (int k = 0; k < 50; ++k) {
    Set(random, program);
    for (int i = 0; i < kSize; ++i) {
      HorizonProgram::Row* const row = program.NewRow();
      ASSERT_NE(row, nullptr);
      row->Add(i, 1.0);
      row->low = -0.1;
      row->most = 0.2;
    }
    Eigen::VectorXd x = Eigen::VectorXd::Zero(kSize);
    const double step = 1.0 / program.H().trace();
    for (int i = 0; i < 20'000; ++i) {
      x -= step * (program.H() * x + program.g());
      x = x.cwiseMax(-0.1).cwiseMin(0.2);
    }
    active += static_cast<int>((x.array() < -0.0999).count() + (x.array() > 0.1999).count());
    worst = std::max(worst, (program.Solve() - x).lpNorm<Eigen::Infinity>());
  }
  std::cout << active << " bounds act, largest difference " << worst << "\n";
  EXPECT_GT(active, 100);
  EXPECT_LT(worst, 1e-5);
}

// Of rows that contradict each other, the one with the larger penalty is kept better, and nothing overflows.
TEST(HorizonProgram, ContradictionEndsInACompromise) {
  HorizonProgram program(1, 2);
  program.Clear();
  program.H()(0, 0) = 1.0;
  for (const double at : {-1.0, 1.0}) {
    HorizonProgram::Row* const row = program.NewRow();
    row->Add(0, 1.0);
    row->low = at;
    row->most = at;
    row->penalty = at > 0.0 ? 30.0 : 1.0;
  }
  const double x = program.Solve()[0];
  EXPECT_GT(x, 0.5);
  EXPECT_LT(x, 1.5);
}

TEST(HorizonProgram, MoreRowsThanThereIsRoomForAreRefused) {
  HorizonProgram program(2, 2);
  program.Clear();
  EXPECT_NE(program.NewRow(), nullptr);
  EXPECT_NE(program.NewRow(), nullptr);
  EXPECT_EQ(program.NewRow(), nullptr);
  program.Clear();
  EXPECT_NE(program.NewRow(), nullptr);
}

}  // namespace
}  // namespace fovea::planning
