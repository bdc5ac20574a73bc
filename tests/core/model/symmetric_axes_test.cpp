// SPDX-License-Identifier: Apache-2.0
// Jacobi's axes and the L D L^T factors of small symmetric matrices, against Eigen.
#include "firmware/core/model/symmetric_axes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <iostream>

#include "tests/support/random_states.hpp"
#include "tests/support/repetitions.hpp"

namespace fovea::model {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Entries = std::array<double, 8>;

// A random matrix of any scale, rank and spread of eigenvalues, some of them equal.
MatrixXd RandomSymmetric(test::RandomStates& random, Eigen::Index n, int kind) {
  MatrixXd J(n, n + 1);
  for (Eigen::Index i = 0; i < J.size(); ++i) {
    J.data()[i] = random.Uniform(-1.0, 1.0);
  }
  const double scale = std::pow(10.0, random.Uniform(-4.0, 4.0));
  switch (kind % 5) {
    case 0: return scale * J * J.transpose();
    case 1: J.bottomRows(n / 2) = J.topRows(n / 2); return scale * J * J.transpose();
    case 2: {
      for (Eigen::Index i = 0; i < n; ++i) {
        J.row(i) *= std::pow(10.0, random.Uniform(-5.0, 0.0));
      }
      return scale * J * J.transpose();
    }
    case 3: return scale * (MatrixXd::Identity(n, n) + 1e-9 * (J.leftCols(n) + J.leftCols(n).transpose()));
    default: return scale * (J.leftCols(n) + J.leftCols(n).transpose());  // of any sign
  }
}

model::Square8 ToSquare(const MatrixXd& A) {
  model::Square8 square{};
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    for (Eigen::Index j = 0; j < A.cols(); ++j) {
      square[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = A(i, j);
    }
  }
  return square;
}

struct Worst {
  double value = 0.0;    // error of an eigenvalue, relative to the largest
  double product = 0.0;  // error of A x, relative
  double turned = 0.0;   // error of x after ToAxes and FromAxes, relative
  int sweeps = 0;
};

template <std::size_t kSize>
void CompareWithEigen(const MatrixXd& A, test::RandomStates& random, Worst& worst) {
  constexpr auto kRows = static_cast<Eigen::Index>(kSize);
  model::Square8 square = ToSquare(A);
  SymmetricAxes axes;
  axes.Diagonalise<kSize>(square);
  worst.sweeps = std::max(worst.sweeps, axes.sweeps());

  VectorXd values(kRows);
  Entries x{};
  for (std::size_t i = 0; i < kSize; ++i) {
    values[static_cast<Eigen::Index>(i)] = square[i][i];
    x[i] = random.Uniform(-1.0, 1.0);
  }
  VectorXd sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> oracle(A);
  const double size = std::max(oracle.eigenvalues().lpNorm<Eigen::Infinity>(), 1e-300);
  worst.value = std::max(worst.value, (sorted - oracle.eigenvalues()).lpNorm<Eigen::Infinity>() / size);

  const VectorXd given = Eigen::Map<const VectorXd>(x.data(), kRows);
  Entries there_and_back = x;
  axes.ToAxes<kSize>(x);
  Entries y = x;
  for (std::size_t i = 0; i < kSize; ++i) {
    y[i] *= square[i][i];
  }
  axes.FromAxes<kSize>(y);
  axes.ToAxes<kSize>(there_and_back);
  axes.FromAxes<kSize>(there_and_back);
  const VectorXd product = Eigen::Map<const VectorXd>(y.data(), kRows);
  const VectorXd back = Eigen::Map<const VectorXd>(there_and_back.data(), kRows);
  worst.product = std::max(worst.product, (product - A * given).norm() / (size * given.norm()));
  worst.turned = std::max(worst.turned, (back - given).norm() / given.norm());
}

TEST(SymmetricAxesTest, AgreeWithEigenForAnySpectrum) {
  test::RandomStates random(611);
  Worst worst;
  for (int k = 0; k < test::Repetitions(20000); ++k) {
    CompareWithEigen<4>(RandomSymmetric(random, 4, k), random, worst);
    CompareWithEigen<6>(RandomSymmetric(random, 6, k), random, worst);
    CompareWithEigen<8>(RandomSymmetric(random, 8, k), random, worst);
  }
  CompareWithEigen<6>(MatrixXd::Zero(6, 6), random, worst);
  CompareWithEigen<6>(MatrixXd::Ones(6, 6), random, worst);
  CompareWithEigen<6>(MatrixXd::Identity(6, 6), random, worst);
  std::cout << "eigenvalues differ by " << worst.value << ", U a U^T x from A x by " << worst.product
            << ", U U^T x from x by " << worst.turned << " (relative); at most " << worst.sweeps
            << " sweeps\n";
  EXPECT_LT(worst.value, 1e-14);
  EXPECT_LT(worst.product, 1e-14);
  EXPECT_LT(worst.turned, 1e-14);
  EXPECT_LT(worst.sweeps, SymmetricAxes::kMaxSweeps);
}

TEST(LdltTest, SolvesAndDetectsPositiveDefiniteness) {
  test::RandomStates random(612);
  double worst = 0.0;
  int positive = 0;
  int others = 0;
  for (int k = 0; k < test::Repetitions(20000); ++k) {
    const MatrixXd A = RandomSymmetric(random, 6, k);
    const VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(A).eigenvalues();
    const double size = values.lpNorm<Eigen::Infinity>();
    model::Square8 factors = ToSquare(A);
    const bool said = model::FactorLdlt<6>(factors);
    if (std::abs(values[0]) < 1e-13 * size) {
      continue;  // rounding decides
    }
    EXPECT_EQ(said, values[0] > 0.0) << values.transpose();
    if (!said) {
      ++others;
      continue;
    }
    ++positive;
    Entries x{};
    const VectorXd b = VectorXd::Random(6);
    std::copy(b.begin(), b.end(), x.begin());
    model::SolveLdlt<6>(factors, x);
    const VectorXd solution = Eigen::Map<const VectorXd>(x.data(), 6);
    worst = std::max(worst, (A * solution - b).norm() / (size * solution.norm() + b.norm()));
  }
  std::cout << positive << " positive definite, " << others << " not; equations solved within " << worst
            << " (relative)\n";
  EXPECT_GT(positive, test::Repetitions(4000));
  EXPECT_GT(others, test::Repetitions(2000));
  EXPECT_LT(worst, 1e-14);
  model::Square8 factors = ToSquare(MatrixXd::Constant(6, 6, std::nan("")));
  EXPECT_FALSE(model::FactorLdlt<6>(factors));
}

}  // namespace
}  // namespace fovea::model
