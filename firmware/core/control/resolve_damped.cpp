// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/resolve_damped.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace fovea::control {
namespace {

using RowEntries = std::array<double, 8>;

// Rows are padded with zeros, because loops of constant length are faster.
double RowDot(const RowEntries& a, const RowEntries& b) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += a[k] * b[k];
  }
  return sum;
}

// g of a direction with the squared singular value `sigma2`.
double Filter(double sigma2, double threshold2) noexcept {
  if (sigma2 >= threshold2) {
    return 1.0 / sigma2;
  }
  // sigma^2 + damping^2, as one square
  const double half = 0.5 * (1.0 + sigma2 / threshold2);
  return 1.0 / (threshold2 * half * half);
}

// The value with index `greater` after the first `size` values are sorted in descending order.
double FromTheTop(RowEntries values, std::size_t size, std::size_t greater) noexcept {
  std::sort(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size), std::greater<>());
  return values[greater];
}

}  // namespace

DampedInverse::DampedInverse(const DampingConfig& config, const MotionTask& task) noexcept
    : rows_(static_cast<std::size_t>(task.J.rows())), columns_(static_cast<std::size_t>(task.J.cols())) {
  for (std::size_t k = 0; k < columns_; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    shrink_[k] = 1.0 / std::sqrt(task.weight[column]);
    for (std::size_t i = 0; i < rows_; ++i) {
      Jw_[i][k] = task.J(static_cast<Eigen::Index>(i), column) * shrink_[k];
    }
  }
  if (rows_ <= 4) {
    Factor<4>(config);
  } else if (rows_ <= 6) {
    Factor<6>(config);
  } else {
    Factor<8>(config);
  }
}

template <std::size_t kRows>
void DampedInverse::Factor(const DampingConfig& config) noexcept {
  model::Square8 A;
  double trace = 0.0;
  for (std::size_t i = 0; i < kRows; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      A[i][j] = A[j][i] = RowDot(Jw_[i], Jw_[j]);
    }
    trace += A[i][i];
  }
  const double relative2 = config.threshold * config.threshold * trace / static_cast<double>(rows_);
  const double threshold2 = relative2 + config.threshold_floor * config.threshold_floor;
  threshold_ = std::sqrt(threshold2);
  sigma_min_ = threshold_;
  for (std::size_t i = rows_; i < kRows; ++i) {
    A[i][i] = 2.0 * threshold2;  // a padding row is never damped
  }
  // All singular values are above the threshold if A - threshold^2 I is positive definite.
  model::Square8 above;
  for (std::size_t i = 0; i < kRows; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      factors_[i][j] = above[i][j] = A[i][j];
    }
    factors_[i][i] = A[i][i];
    above[i][i] = A[i][i] - threshold2;
  }
  const bool has_factors = model::FactorLdlt<kRows>(factors_);
  const bool is_above = model::FactorLdlt<kRows>(above);
  damped_ = !(has_factors && is_above);
  if (!damped_) {
    return;
  }
  axes_.Diagonalise<kRows>(A);
  RowEntries sigma2{};
  for (std::size_t i = 0; i < kRows; ++i) {
    sigma2[i] = A[i][i] > 0.0 || std::isnan(A[i][i]) ? A[i][i] : 0.0;
    filter_[i] = Filter(sigma2[i], threshold2);
  }
  // Padding rows, and rows beyond the number of joints, do not count.
  const std::size_t counted = kRows - rows_ + std::min(rows_, columns_);
  sigma_min_ = std::sqrt(FromTheTop(sigma2, kRows, counted - 1));
}

// y = g(A) y
template <std::size_t kRows>
void DampedInverse::Apply(RowEntries& y) const noexcept {
  if (!damped_) {
    model::SolveLdlt<kRows>(factors_, y);
    return;
  }
  axes_.ToAxes<kRows>(y);
  for (std::size_t i = 0; i < kRows; ++i) {
    y[i] *= filter_[i];
  }
  axes_.FromAxes<kRows>(y);
}

void DampedInverse::Resolve(const MotionTask& task, DampedMotion& motion) const noexcept {
  motion.threshold = threshold_;
  motion.sigma_min = sigma_min_;
  RowEntries wish{};
  for (std::size_t k = 0; k < columns_; ++k) {
    wish[k] = task.dq_0[static_cast<Eigen::Index>(k)] / shrink_[k];
  }
  RowEntries y{};
  for (std::size_t i = 0; i < rows_; ++i) {
    y[i] = task.v[static_cast<Eigen::Index>(i)] - RowDot(Jw_[i], wish);
  }
  if (rows_ <= 4) {
    Apply<4>(y);
  } else if (rows_ <= 6) {
    Apply<6>(y);
  } else {
    Apply<8>(y);
  }
  for (std::size_t i = 0; i < rows_; ++i) {
    for (std::size_t k = 0; k < wish.size(); ++k) {
      wish[k] += Jw_[i][k] * y[i];
    }
  }
  motion.dq.resize(static_cast<Eigen::Index>(columns_));
  for (std::size_t k = 0; k < columns_; ++k) {
    motion.dq[static_cast<Eigen::Index>(k)] = wish[k] * shrink_[k];
  }
  motion.finite = motion.dq.allFinite() && std::isfinite(motion.threshold);
  if (!motion.finite) {
    motion.dq.setZero();
  }
}

void ResolveDamped(const DampingConfig& config, const MotionTask& task, DampedMotion& motion) noexcept {
  DampedInverse(config, task).Resolve(task, motion);
}

}  // namespace fovea::control
