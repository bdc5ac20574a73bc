// SPDX-License-Identifier: Apache-2.0
// Singular values and vectors of a small matrix, in a bounded number of steps: one-sided Jacobi. Rotations of
// pairs of rows make all rows orthogonal to each other, J = U R with R = diag(sigma) V^T (Golub and Van Loan,
// Matrix Computations, 2013, sec. 8.6.3). Small singular values come out as accurate as large ones, and R is
// well defined even where sigma = 0 and V^T is not.
#pragma once

#include <array>

#include "firmware/core/features/feature_state.hpp"

namespace fovea::barriers {

// [dim x num_joints] task Jacobian: ds/dt = J dq.
using TaskJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, features::kMaxDim,
                                   model::kMaxJoints>;

struct RowSvd {
  static constexpr int kMaxSweeps = 12;  // a matrix of 6 or 8 rows takes five to seven

  int rows = 0;
  int columns = 0;
  int sweeps = 0;                                 // done; kMaxSweeps: perhaps not converged
  std::array<double, features::kMaxDim> sigma{};  // [rows] descending; zero past min(rows, columns)
  std::array<std::array<double, features::kMaxDim>, features::kMaxDim> u{};  // u[i] left singular vector i
  std::array<std::array<double, model::kMaxJoints>, features::kMaxDim> r{};  // r[i] = sigma[i] * v_i^T

  // The smallest of the min(rows, columns) singular values; 0 for an empty matrix.
  [[nodiscard]] double Smallest() const noexcept {
    const int last = (rows < columns ? rows : columns) - 1;
    return last < 0 ? 0.0 : sigma[static_cast<std::size_t>(last)];
  }
};

// `J` [m x n], m and n at most 8. Non-finite input gives non-finite output. Real-time: yes.
void ComputeRowSvd(const TaskJacobian& J, RowSvd& svd) noexcept;

}  // namespace fovea::barriers
