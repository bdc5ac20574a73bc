#include "fovea/servo/compress_task.hpp"

#include <cmath>

namespace fovea::servo {
namespace {

constexpr Eigen::Index kRows = 6;

// Reflects column `x` of a matrix, from row `k` on, by I - tau h h^T with h [rows - k], h_0 = 1.
template <typename Column>
void Reflect(const features::FeatureVector& h, double tau, Eigen::Index k, Column&& x) noexcept {
  double share = 0.0;
  for (Eigen::Index i = 0; i < h.size(); ++i) {
    share += h[i] * x[k + i];
  }
  for (Eigen::Index i = 0; i < h.size(); ++i) {
    x[k + i] -= tau * share * h[i];
  }
}

}  // namespace

void CompressTask(features::InteractionMatrix& L, features::FeatureVector& v) noexcept {
  const Eigen::Index rows = L.rows();
  if (rows <= kRows) {
    return;
  }
  for (Eigen::Index k = 0; k < kRows; ++k) {
    double below2 = 0.0;
    for (Eigen::Index i = k + 1; i < rows; ++i) {
      below2 += L(i, k) * L(i, k);
    }
    if (below2 == 0.0) {
      continue;
    }
    // Golub and Van Loan, Matrix Computations (2013), section 5.1: the sign that cancels nothing.
    const double first = L(k, k);
    const double length = std::sqrt(first * first + below2);
    const double pivot = first + std::copysign(length, first);
    features::FeatureVector h(rows - k);
    h[0] = 1.0;
    for (Eigen::Index i = 1; i < h.size(); ++i) {
      h[i] = L(k + i, k) / pivot;
    }
    const double tau = 2.0 * pivot * pivot / (pivot * pivot + below2);
    for (Eigen::Index c = k; c < kRows; ++c) {
      Reflect(h, tau, k, L.col(c));
    }
    Reflect(h, tau, k, v);
  }
  const features::InteractionMatrix R = L.topRows(kRows);
  const features::FeatureVector head = v.head(kRows);
  L = R;
  v = head;
}

}  // namespace fovea::servo
