// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/compress_task.hpp"

#include <array>
#include <cmath>

namespace fovea::control {
namespace {

constexpr std::size_t kRows = 6;

using Column = std::array<double, features::kMaxDim>;
static_assert(features::kMaxDim == 8, "a sum of four pairs");

double ColumnDot(const Column& a, const Column& b) noexcept {
  std::array<double, 4> pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i] = a[i] * b[i] + a[i + 4] * b[i + 4];
  }
  return (pairs[0] + pairs[1]) + (pairs[2] + pairs[3]);
}

}  // namespace

void CompressTask(features::InteractionMatrix& L, features::FeatureVector& v) noexcept {
  const auto rows = static_cast<std::size_t>(L.rows());
  if (rows <= kRows) {
    return;
  }
  // The columns of L, and v as one more; missing rows are zero.
  std::array<Column, kRows + 1> columns{};
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t c = 0; c < kRows; ++c) {
      columns[c][i] = L(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c));
    }
    columns[kRows][i] = v[static_cast<Eigen::Index>(i)];
  }
  L.setZero(kRows, 6);
  v.setZero(kRows);
  for (std::size_t k = 0; k < kRows; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Column& a = columns[k];
    const double length2 = ColumnDot(a, a);
    if (!(length2 > 0.0) && !std::isnan(length2)) {
      continue;
    }
    // The root scales only the results written here, so that the next columns do not wait for it.
    const double share = 1.0 / length2;
    const double length = std::sqrt(length2);
    L(row, row) = length;
#pragma GCC unroll 8
    for (std::size_t c = k + 1; c <= kRows; ++c) {
      const double part = ColumnDot(a, columns[c]) * share;
      (c < kRows ? L(row, static_cast<Eigen::Index>(c)) : v[row]) = part * length;
      for (std::size_t i = 0; i < a.size(); ++i) {
        columns[c][i] -= part * a[i];
      }
    }
  }
}

}  // namespace fovea::control
