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

// Solves L L^T x = b in place, `L` from FactorCholesky; `x` [n], or [n x m] column by column.
// Real-time: yes.
template <typename Matrix, typename Vectors>
void SolveCholesky(const Matrix& L, Vectors& x) noexcept {
  const Eigen::Index n = L.rows();
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < i; ++k) {
        x(i, c) -= L(i, k) * x(k, c);
      }
      x(i, c) /= L(i, i);
    }
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      for (Eigen::Index k = i + 1; k < n; ++k) {
        x(i, c) -= L(k, i) * x(k, c);
      }
      x(i, c) /= L(i, i);
    }
  }
}

}  // namespace fovea::model
