// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/singularity.hpp"

#include <algorithm>

#include "firmware/core/barriers/row_svd.hpp"

namespace fovea::barriers {

void ComputeSingularity(const model::Mat6N& J, double length, Singularity& singularity) noexcept {
  const int n = static_cast<int>(J.cols());
  singularity.sigma = 0.0;
  singularity.gradient = model::VecN::Zero(n);
  if (n == 0) {
    return;
  }
  TaskJacobian scaled = J;
  scaled.topRows<3>() /= length;
  RowSvd svd;
  ComputeRowSvd(scaled, svd);
  const auto last = static_cast<std::size_t>(std::min(n, 6) - 1);
  singularity.sigma = svd.sigma[last];
  if (!(singularity.sigma > 0.0)) {
    return;
  }
  model::Vec6 u;
  for (Eigen::Index i = 0; i < 6; ++i) {
    u[i] = svd.u[last][static_cast<std::size_t>(i)];
  }
  u.head<3>() /= length;  // so that it multiplies changes of the unscaled J
  for (int j = 0; j + 1 < n; ++j) {
    const double v_j = svd.r[last][static_cast<std::size_t>(j)] / singularity.sigma;
    for (int k = j + 1; k < n; ++k) {
      singularity.gradient[k] += v_j * u.dot(model::ColumnChange(J, j, k));
    }
  }
}

bool IsNear(const SingularityConfig& config, const model::Mat6N& J, double speed, double reach,
            SingularityWatch& watch, Singularity& singularity) noexcept {
  // No column of the scaled dJ/dq_k is longer than 2 reach / length + 1. The norm over all columns bounds the
  // rate of change of every singular value.
  const double rate = (2.0 * reach / config.length + 1.0) * std::sqrt(static_cast<double>(J.cols()));
  watch.sigma -= rate * speed * hal::kTickPeriodS;
  const double near = config.sigma_min + SingularityWatch::kNear;
  if (watch.sigma > near) {
    return false;
  }
  ComputeSingularity(J, config.length, singularity);
  watch.sigma = singularity.sigma;
  return !(singularity.sigma > near);
}

Barrier SingularityBarrier(const SingularityConfig& config, const Singularity& singularity) noexcept {
  Barrier barrier;
  barrier.name = hal::Limit::kSingularity;
  barrier.value = singularity.sigma;
  barrier.gradient = singularity.gradient;
  barrier.margin = config.sigma_min;
  barrier.rate = config.rate;
  return barrier;
}

}  // namespace fovea::barriers
