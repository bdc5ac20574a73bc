// Cholesky factor and triangular solves for small symmetric positive definite matrices. Sums run in one order
// whatever the vector width. A pivot that is not positive gives NaN, which a caller's check for finite values
// finds. Real-time: yes, all.
#pragma once

#include <cmath>

#include "fovea/model/types.hpp"

namespace fovea::servo {

// A = L L^T: `A` [n x n] becomes L in its lower half; the upper half is left alone.
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

// Solves L x = b in place.
template <typename Matrix, typename Vector>
void SolveLower(const Matrix& L, Vector& x) noexcept {
  for (Eigen::Index i = 0; i < L.rows(); ++i) {
    double sum = x[i];
    for (Eigen::Index k = 0; k < i; ++k) {
      sum -= L(i, k) * x[k];
    }
    x[i] = sum / L(i, i);
  }
}

// Solves L^T x = b in place.
template <typename Matrix, typename Vector>
void SolveLowerTransposed(const Matrix& L, Vector& x) noexcept {
  for (Eigen::Index i = L.rows() - 1; i >= 0; --i) {
    double sum = x[i];
    for (Eigen::Index k = i + 1; k < L.rows(); ++k) {
      sum -= L(k, i) * x[k];
    }
    x[i] = sum / L(i, i);
  }
}

}  // namespace fovea::servo
