// SPDX-License-Identifier: Apache-2.0
// Symmetric positive definite systems of a few equations, without a heap and in a fixed order of operations.
#pragma once

#include <Eigen/Core>
#include <cmath>

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

// Solves L x = b in place, `L` from FactorCholesky; `x` [n], or [n x m] column by column. Real-time: yes.
template <typename Matrix, typename Vectors>
void SolveLower(const Matrix& L, Vectors& x) noexcept {
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    for (Eigen::Index i = 0; i < L.rows(); ++i) {
      double sum = x(i, c);
      for (Eigen::Index k = 0; k < i; ++k) {
        sum -= L(i, k) * x(k, c);
      }
      x(i, c) = sum / L(i, i);
    }
  }
}

// Solves L^T x = b in place. Real-time: yes.
template <typename Matrix, typename Vectors>
void SolveLowerTransposed(const Matrix& L, Vectors& x) noexcept {
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    for (Eigen::Index i = L.rows() - 1; i >= 0; --i) {
      double sum = x(i, c);
      for (Eigen::Index k = i + 1; k < L.rows(); ++k) {
        sum -= L(k, i) * x(k, c);
      }
      x(i, c) = sum / L(i, i);
    }
  }
}

// Solves L L^T x = b in place. Real-time: yes.
template <typename Matrix, typename Vectors>
void SolveCholesky(const Matrix& L, Vectors& x) noexcept {
  SolveLower(L, x);
  SolveLowerTransposed(L, x);
}

}  // namespace fovea::model
