// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/design/linear_system.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <unsupported/Eigen/MatrixFunctions>

namespace fovea::design {

Eigen::VectorXd LinearResponse(const Eigen::MatrixXd& A, const Eigen::VectorXd& x0, double t) {
  const Eigen::MatrixXd transition = (A * t).exp();
  return transition * x0;
}

std::vector<std::complex<double>> Eigenvalues(const Eigen::MatrixXd& A) {
  const Eigen::VectorXcd values = A.eigenvalues();
  return {values.begin(), values.end()};
}

std::vector<std::complex<double>> Poles(const Eigen::MatrixXd& A) {
  std::vector<std::complex<double>> poles = Eigenvalues(A);
  std::sort(poles.begin(), poles.end(), [](const auto& one, const auto& other) {
    return one.real() != other.real() ? one.real() > other.real() : one.imag() > other.imag();
  });
  return poles;
}

Eigen::MatrixXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  return A.completeOrthogonalDecomposition().solve(B);
}

Eigen::Matrix3d IntegralLoop(double k_p, double k_v, double k_i) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  A(0, 1) = A(1, 2) = 1.0;
  A.row(2) << -k_i, -k_p, -k_v;
  return A;
}

}  // namespace fovea::design
