// SPDX-License-Identifier: Apache-2.0
// The active limits of the dual active-set method (move_into_limits.hpp), at most one per joint: multipliers,
// and normals as N = Q R with Q orthonormal and R upper triangular. The normals are in coordinates in which
// the cost is the Euclidean distance. Real-time: yes, all functions.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/model/types.hpp"

namespace fovea::control {

struct ActiveSet {
  int size = 0;
  std::array<int, model::kMaxJoints> limit{};
  std::array<double, model::kMaxJoints> multiplier{};
  std::array<model::VecN, model::kMaxJoints> normal;
  std::array<model::VecN, model::kMaxJoints> Q;
  std::array<std::array<double, model::kMaxJoints>, model::kMaxJoints> R{};  // R[column][row]
  std::uint64_t members = 0;                                                 // bit per limit

  // Splits `vector` into `along`, its coordinates along Q, and the rest, which replaces it.
  void Split(model::VecN& vector, std::array<double, model::kMaxJoints>& along) const noexcept {
    along.fill(0.0);
    for (int pass = 0; pass < 2; ++pass) {  // the second pass removes rounding errors
      for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
        const double share = Q[i].dot(vector);
        along[i] += share;
        vector -= share * Q[i];
      }
    }
  }

  // Replaces x by R^-1 x.
  void SolveR(std::array<double, model::kMaxJoints>& x) const noexcept {
    for (int i = size - 1; i >= 0; --i) {
      const auto row = static_cast<std::size_t>(i);
      for (auto column = row + 1; column < static_cast<std::size_t>(size); ++column) {
        x[row] -= R[column][row] * x[column];
      }
      x[row] /= R[row][row];
    }
  }

  // `rest` and `along`: results of Split for `whitened`.
  void Add(int new_limit, double new_multiplier, const model::VecN& whitened, const model::VecN& rest,
           const std::array<double, model::kMaxJoints>& along) noexcept {
    const auto k = static_cast<std::size_t>(size);
    limit[k] = new_limit;
    multiplier[k] = new_multiplier;
    normal[k] = whitened;
    const double length = rest.norm();
    Q[k] = rest / length;
    R[k] = along;
    R[k][k] = length;
    members |= std::uint64_t{1} << static_cast<unsigned>(new_limit);
    ++size;
  }

  void Drop(int index) noexcept {
    const int old_size = size;
    const auto dropped = static_cast<std::size_t>(index);
    members &= ~(std::uint64_t{1} << static_cast<unsigned>(limit[dropped]));
    size = index;
    for (std::size_t k = dropped + 1; k < static_cast<std::size_t>(old_size); ++k) {
      const model::VecN whitened = normal[k];
      model::VecN rest = whitened;
      std::array<double, model::kMaxJoints> along;
      Split(rest, along);
      Add(limit[k], multiplier[k], whitened, rest, along);
    }
  }
};

}  // namespace fovea::control
