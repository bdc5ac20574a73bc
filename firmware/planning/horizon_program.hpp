// SPDX-License-Identifier: Apache-2.0
// A quadratic program with sparse rows:
//
//   minimise  x^T H x / 2 + g^T x   subject to  low <= a^T x <= most for each row a
//
// by the alternating direction method of multipliers, with a fixed number of iterations: bounded work, and a
// compromise if the rows contradict each other. (Stellato and others, OSQP: an operator splitting solver for
// quadratic programs, Mathematical Programming Computation 2020.)
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace fovea::planning {

class HorizonProgram {
 public:
  static constexpr int kMostEntries = 24;  // of a row

  struct Row {
    int size = 0;
    std::array<int, kMostEntries> place{};
    std::array<double, kMostEntries> a{};
    double low = 0.0;
    double most = 0.0;
    double penalty = 1.0;  // where rows contradict each other, one with a larger penalty is kept better

    void Add(int at, double value) noexcept {
      place[static_cast<std::size_t>(size)] = at;
      a[static_cast<std::size_t>(size)] = value;
      ++size;
    }
    [[nodiscard]] double Times(const Eigen::VectorXd& x) const noexcept {
      double sum = 0.0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
        sum += a[i] * x[place[i]];
      }
      return sum;
    }
  };

  // Allocates for `size` unknowns and `most_rows` rows.
  HorizonProgram(int size, int most_rows);

  // Begins a new program without rows, H and g zero.
  void Clear() noexcept;
  [[nodiscard]] Eigen::MatrixXd& H() noexcept { return H_; }
  [[nodiscard]] Eigen::VectorXd& g() noexcept { return g_; }
  // A new row, empty; null if there is no room.
  [[nodiscard]] Row* NewRow() noexcept;

  // The solution, or the best compromise after all iterations; 0 if H is not positive definite.
  [[nodiscard]] const Eigen::VectorXd& Solve() noexcept;

 private:
  // True if the minimum without rows, which is left in x_, keeps them all.
  [[nodiscard]] bool SolveWithoutRows() noexcept;

  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
  std::vector<Row> rows_;
  std::size_t num_rows_ = 0;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd K_;
  Eigen::VectorXd x_;
  Eigen::VectorXd right_;
  Eigen::VectorXd z_;  // a^T x of each row, within its bounds
  Eigen::VectorXd y_;  // multipliers
};

}  // namespace fovea::planning
