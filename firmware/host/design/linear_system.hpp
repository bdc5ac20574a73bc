// SPDX-License-Identifier: Apache-2.0
// Linear systems of any order, x' = A x: poles, free motion and their fit to samples. The loop with integral
// action is one of them.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace fovea::design {

// x(t) [n] = exp(A t) x0, for `A` [n x n] in [1/s] and t in [s]. Real-time: no, like all of design/.
[[nodiscard]] Eigen::VectorXd LinearResponse(const Eigen::MatrixXd& A, const Eigen::VectorXd& x0, double t);

// The eigenvalues of `A` [n x n], in no particular order.
[[nodiscard]] std::vector<std::complex<double>> Eigenvalues(const Eigen::MatrixXd& A);

// The eigenvalues of `A` [n x n], the largest real part first; of a pair, the one above the real axis first.
[[nodiscard]] std::vector<std::complex<double>> Poles(const Eigen::MatrixXd& A);

// X [n x k] with the least |A X - B|, for `A` [m x n] and `B` [m x k]; of several, the smallest.
[[nodiscard]] Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);

// e''' + k_v e'' + k_p e' + k_i e = 0 as A for the state (e, e', e''): the error of a partitioned plant under
// PD with integral action. Gains per unit of mass: `k_p` [1/s^2], `k_v` [1/s], `k_i` [1/s^3].
[[nodiscard]] Eigen::Matrix3d IntegralLoop(double k_p, double k_v, double k_i);

}  // namespace fovea::design
