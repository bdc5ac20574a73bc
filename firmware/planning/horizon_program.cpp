// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/horizon_program.hpp"

#include <algorithm>

namespace fovea::planning {
namespace {

constexpr int kIterations = 80;
constexpr double kPenalty = 10.0;    // of a row's deviation
constexpr double kProximity = 1e-6;  // of an iteration's step
constexpr double kRelaxation = 1.6;

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

const Eigen::VectorXd& HorizonProgram::Solve() noexcept {
  K_ = H_;
  K_.diagonal().array() += kProximity;
  for (std::size_t r = 0; r < num_rows_; ++r) {
    const Row& row = rows_[r];
    for (std::size_t i = 0; i < static_cast<std::size_t>(row.size); ++i) {
      for (std::size_t j = 0; j < static_cast<std::size_t>(row.size); ++j) {
        K_(row.place[i], row.place[j]) += kPenalty * row.a[i] * row.a[j];
      }
    }
  }
  factor_.compute(K_);
  x_.setZero();
  y_.setZero();
  for (std::size_t r = 0; r < num_rows_; ++r) {
    z_[static_cast<Eigen::Index>(r)] = std::clamp(0.0, rows_[r].low, rows_[r].most);
  }
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    right_ = kProximity * x_ - g_;
    for (std::size_t r = 0; r < num_rows_; ++r) {
      const Row& row = rows_[r];
      const auto k = static_cast<Eigen::Index>(r);
      const double pull = kPenalty * z_[k] - y_[k];
      for (std::size_t i = 0; i < static_cast<std::size_t>(row.size); ++i) {
        right_[row.place[i]] += row.a[i] * pull;
      }
    }
    factor_.solveInPlace(right_);
    x_ += kRelaxation * (right_ - x_);
    for (std::size_t r = 0; r < num_rows_; ++r) {
      const auto k = static_cast<Eigen::Index>(r);
      const double relaxed = kRelaxation * rows_[r].Times(right_) + (1.0 - kRelaxation) * z_[k];
      z_[k] = std::clamp(relaxed + y_[k] / kPenalty, rows_[r].low, rows_[r].most);
      y_[k] += kPenalty * (relaxed - z_[k]);
    }
  }
  return x_;
}

}  // namespace fovea::planning
