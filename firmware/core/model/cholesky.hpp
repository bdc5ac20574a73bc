// SPDX-License-Identifier: Apache-2.0
// Symmetric positive definite systems of a few equations, without a heap and in a fixed order of operations.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <type_traits>

namespace fovea::model {

// Cholesky factor of `A` [n x n] in its lower half, in place. A pivot that is not positive gives NaN, which
// the caller's check for finite values finds. Real-time: yes.
template <typename Matrix>
void FactorCholesky(Matrix& A) noexcept {
  const Eigen::Index n = A.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      double sum = A(i, j);
      for (Eigen::Index k = 0; k < j; ++k) {
        sum -= A(i, k) * A(j, k);
      }
      A(i, j) = i == j ? std::sqrt(sum) : sum / A(j, j);
    }
  }
}

// Calls solve(c, width) for all columns of `x`, by fours and then one by one. Four at once load each entry of
// L once; each column's operations stay the same.
template <typename Vectors, typename Solve>
void ForColumns(const Vectors& x, const Solve& solve) noexcept {
  Eigen::Index c = 0;
  if constexpr (Vectors::ColsAtCompileTime != 1) {
    for (; c + 4 <= x.cols(); c += 4) {
      solve(c, std::integral_constant<int, 4>{});
    }
  }
  if constexpr (Vectors::ColsAtCompileTime == Eigen::Dynamic || Vectors::ColsAtCompileTime % 4 != 0) {
    for (; c < x.cols(); ++c) {
      solve(c, std::integral_constant<int, 1>{});
    }
  }
}

// Solves L x = b in place, `L` from FactorCholesky; `x` [n], or [n x m] column by column. Real-time: yes.
template <typename Matrix, typename Vectors>
void SolveLower(const Matrix& L, Vectors& x) noexcept {
  ForColumns(x, [&](Eigen::Index c, auto width) {
    for (Eigen::Index i = 0; i < L.rows(); ++i) {
      std::array<double, width> sum;
      for (int j = 0; j < width; ++j) {
        sum[static_cast<std::size_t>(j)] = x(i, c + j);
      }
      for (Eigen::Index k = 0; k < i; ++k) {
        const double factor = L(i, k);
        for (int j = 0; j < width; ++j) {
          sum[static_cast<std::size_t>(j)] -= factor * x(k, c + j);
        }
      }
      const double pivot = L(i, i);
      for (int j = 0; j < width; ++j) {
        x(i, c + j) = sum[static_cast<std::size_t>(j)] / pivot;
      }
    }
  });
}

// Solves L^T x = b in place. Real-time: yes.
template <typename Matrix, typename Vectors>
void SolveLowerTransposed(const Matrix& L, Vectors& x) noexcept {
  ForColumns(x, [&](Eigen::Index c, auto width) {
    for (Eigen::Index i = L.rows() - 1; i >= 0; --i) {
      std::array<double, width> sum;
      for (int j = 0; j < width; ++j) {
        sum[static_cast<std::size_t>(j)] = x(i, c + j);
      }
      for (Eigen::Index k = i + 1; k < L.rows(); ++k) {
        const double factor = L(k, i);
        for (int j = 0; j < width; ++j) {
          sum[static_cast<std::size_t>(j)] -= factor * x(k, c + j);
        }
      }
      const double pivot = L(i, i);
      for (int j = 0; j < width; ++j) {
        x(i, c + j) = sum[static_cast<std::size_t>(j)] / pivot;
      }
    }
  });
}

// Solves L L^T x = b in place. Real-time: yes.
template <typename Matrix, typename Vectors>
void SolveCholesky(const Matrix& L, Vectors& x) noexcept {
  SolveLower(L, x);
  SolveLowerTransposed(L, x);
}

}  // namespace fovea::model
