// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/horizon_program.hpp"

#include <algorithm>

namespace fovea::planning {
namespace {

constexpr int kIterations = 80;
constexpr double kProximity = 1e-9;  // of an iteration's step
constexpr double kRelaxation = 1.6;

// x = (L L^T)^-1 x. (Eigen's own takes memory for large systems.)
void SolveBy(const Eigen::MatrixXd& L, Eigen::VectorXd& x) noexcept {
  const Eigen::Index n = x.size();
  for (Eigen::Index j = 0; j < n; ++j) {
    x[j] /= L(j, j);
    for (Eigen::Index i = j + 1; i < n; ++i) {
      x[i] -= L(i, j) * x[j];
    }
  }
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    for (Eigen::Index i = j + 1; i < n; ++i) {
      x[j] -= L(i, j) * x[i];
    }
    x[j] /= L(j, j);
  }
}

}  // namespace

HorizonProgram::HorizonProgram(int size, int most_rows)
    : H_(size, size),
      g_(size),
      rows_(static_cast<std::size_t>(most_rows)),
      factor_(size),
      K_(size, size),
      x_(size),
      right_(size),
      z_(most_rows),
      y_(most_rows) {}

void HorizonProgram::Clear() noexcept {
  H_.setZero();
  g_.setZero();
  num_rows_ = 0;
}

HorizonProgram::Row* HorizonProgram::NewRow() noexcept {
  if (num_rows_ == rows_.size()) {
    return nullptr;
  }
  rows_[num_rows_] = Row{};
  return &rows_[num_rows_++];
}

bool HorizonProgram::SolveWithoutRows() noexcept {
  K_ = H_;
  K_.diagonal().array() += kProximity;
  factor_.compute(K_);
  if (factor_.info() != Eigen::Success) {
    return false;
  }
  x_ = -g_;
  SolveBy(factor_.matrixLLT(), x_);
  return std::all_of(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(num_rows_),
                     [this](const Row& row) {
                       const double value = row.Times(x_);
                       return value >= row.low && value <= row.most;
                     });
}

const Eigen::VectorXd& HorizonProgram::Solve() noexcept {
  if (SolveWithoutRows()) {
    return x_;  // exact, which the iterations below are not in directions that hardly change the cost
  }
  K_ = H_;
  K_.diagonal().array() += kProximity;
  for (std::size_t r = 0; r < num_rows_; ++r) {
    const Row& row = rows_[r];
    for (std::size_t i = 0; i < static_cast<std::size_t>(row.size); ++i) {
      for (std::size_t j = 0; j < static_cast<std::size_t>(row.size); ++j) {
        K_(row.place[i], row.place[j]) += row.penalty * row.a[i] * row.a[j];
      }
    }
  }
  factor_.compute(K_);
  x_.setZero();
  if (factor_.info() != Eigen::Success) {
    return x_;
  }
  y_.setZero();
  for (std::size_t r = 0; r < num_rows_; ++r) {
    z_[static_cast<Eigen::Index>(r)] = std::clamp(0.0, rows_[r].low, rows_[r].most);
  }
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    right_ = kProximity * x_ - g_;
    for (std::size_t r = 0; r < num_rows_; ++r) {
      const Row& row = rows_[r];
      const auto k = static_cast<Eigen::Index>(r);
      const double pull = row.penalty * z_[k] - y_[k];
      for (std::size_t i = 0; i < static_cast<std::size_t>(row.size); ++i) {
        right_[row.place[i]] += row.a[i] * pull;
      }
    }
    SolveBy(factor_.matrixLLT(), right_);
    x_ += kRelaxation * (right_ - x_);
    for (std::size_t r = 0; r < num_rows_; ++r) {
      const Row& row = rows_[r];
      const auto k = static_cast<Eigen::Index>(r);
      const double relaxed = kRelaxation * row.Times(right_) + (1.0 - kRelaxation) * z_[k];
      z_[k] = std::clamp(relaxed + y_[k] / row.penalty, row.low, row.most);
      y_[k] += row.penalty * (relaxed - z_[k]);
    }
  }
  return x_;
}

}  // namespace fovea::planning
