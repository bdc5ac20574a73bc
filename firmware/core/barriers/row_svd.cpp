// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/row_svd.hpp"

#include <cmath>
#include <utility>

namespace fovea::barriers {
namespace {

constexpr double kOrthogonal = 1e-15;  // cosine of two rows that count as orthogonal
constexpr double kNothing = 1e-16;     // a row this small relative to the matrix is rounding error

using Row = std::array<double, 8>;
static_assert(features::kMaxDim == 8 && model::kMaxJoints == 8, "one type for the rows of U^T and of R");

// Rows are padded with zeros, because loops of constant length are faster.
double Dot(const Row& a, const Row& b) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += a[k] * b[k];
  }
  return sum;
}

void Rotate(Row& a, Row& b, double c, double s) noexcept {
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double a_k = a[k];
    a[k] = c * a_k - s * b[k];
    b[k] = s * a_k + c * b[k];
  }
}

// Makes rows i and j orthogonal; false if they already were. `nothing2`: squared norm of rounding errors.
bool Orthogonalise(RowSvd& svd, double nothing2, std::size_t i, std::size_t j) noexcept {
  const double ii = Dot(svd.r[i], svd.r[i]);
  const double jj = Dot(svd.r[j], svd.r[j]);
  const double ij = Dot(svd.r[i], svd.r[j]);
  if (ij * ij <= kOrthogonal * kOrthogonal * ii * jj || ii <= nothing2 || jj <= nothing2) {
    return false;
  }
  // Two angles do it. This is the smaller one.
  const double half = 0.5 * (jj - ii);
  const double t = ij / (half + std::copysign(std::sqrt(half * half + ij * ij), half));
  const double c = 1.0 / std::sqrt(1.0 + t * t);
  Rotate(svd.r[i], svd.r[j], c, c * t);
  Rotate(svd.u[i], svd.u[j], c, c * t);
  return true;
}

}  // namespace

void ComputeRowSvd(const TaskJacobian& J, RowSvd& svd) noexcept {
  svd.rows = static_cast<int>(J.rows());
  svd.columns = static_cast<int>(J.cols());
  const auto m = static_cast<std::size_t>(svd.rows);
  for (std::size_t i = 0; i < m; ++i) {
    svd.r[i].fill(0.0);
    for (int k = 0; k < svd.columns; ++k) {
      svd.r[i][static_cast<std::size_t>(k)] = J(static_cast<Eigen::Index>(i), k);
    }
    svd.u[i].fill(0.0);
    svd.u[i][i] = 1.0;
  }
  const double nothing2 = kNothing * kNothing * J.squaredNorm();
  bool rotated = true;
  for (svd.sweeps = 0; rotated && svd.sweeps < RowSvd::kMaxSweeps; ++svd.sweeps) {
    rotated = false;
    for (std::size_t i = 0; i + 1 < m; ++i) {
      for (std::size_t j = i + 1; j < m; ++j) {
        rotated |= Orthogonalise(svd, nothing2, i, j);
      }
    }
  }
  for (std::size_t i = 0; i < m; ++i) {
    svd.sigma[i] = std::sqrt(Dot(svd.r[i], svd.r[i]));
  }
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = i; j > 0 && svd.sigma[j] > svd.sigma[j - 1]; --j) {
      std::swap(svd.sigma[j], svd.sigma[j - 1]);
      std::swap(svd.u[j], svd.u[j - 1]);
      std::swap(svd.r[j], svd.r[j - 1]);
    }
  }
}

}  // namespace fovea::barriers
