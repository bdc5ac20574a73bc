// SPDX-License-Identifier: Apache-2.0
// Symmetric systems of a few equations, without roots: A = L D L^T, L with ones on its diagonal. The size is
// known at compile time, so that all loops are unrolled. One division per equation. (cholesky.hpp is for
// sizes that are known only at run time.)
#pragma once

#include <array>
#include <cstddef>

namespace fovea::model {

// Room for a matrix of up to eight rows, row by row.
using Square8 = std::array<std::array<double, 8>, 8>;

// Factors the lower half of `A` [kSize x kSize] in place: L below the diagonal, 1 / D on it. False if a pivot
// is not positive: A is not positive definite or not finite. `A` is then useless. Real-time: yes.
template <std::size_t kSize>
[[nodiscard]] bool FactorLdlt(Square8& A) noexcept {
  static_assert(kSize <= 8);
  bool positive = true;
  Square8 rest;  // A without the finished columns; in registers, because the loops are unrolled
#pragma GCC unroll 8
  for (std::size_t i = 0; i < kSize; ++i) {
#pragma GCC unroll 8
    for (std::size_t k = 0; k <= i; ++k) {
      rest[i][k] = A[i][k];
    }
  }
#pragma GCC unroll 8
  for (std::size_t j = 0; j < kSize; ++j) {
    positive &= rest[j][j] > 0.0;
    A[j][j] = 1.0 / rest[j][j];
#pragma GCC unroll 8
    for (std::size_t i = j + 1; i < kSize; ++i) {
      const double share = rest[i][j] * A[j][j];
      A[i][j] = share;
#pragma GCC unroll 8
      for (std::size_t k = j + 1; k <= i; ++k) {
        rest[i][k] -= share * rest[k][j];
      }
    }
  }
  return positive;
}

// x = A^-1 x for the factors of `A`; `x` of kSize entries or more. Real-time: yes.
template <std::size_t kSize>
void SolveLdlt(const Square8& A, std::array<double, 8>& x) noexcept {
#pragma GCC unroll 8
  for (std::size_t j = 0; j < kSize; ++j) {
#pragma GCC unroll 8
    for (std::size_t i = j + 1; i < kSize; ++i) {
      x[i] -= A[i][j] * x[j];
    }
  }
#pragma GCC unroll 8
  for (std::size_t i = 0; i < kSize; ++i) {
    x[i] *= A[i][i];
  }
#pragma GCC unroll 8
  for (std::size_t left = 0; left < kSize; ++left) {
    const std::size_t j = kSize - 1 - left;
#pragma GCC unroll 8
    for (std::size_t i = 0; i < j; ++i) {
      x[i] -= A[j][i] * x[j];
    }
  }
}

}  // namespace fovea::model
