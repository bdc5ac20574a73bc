#include "fovea/servo/resolve_damped.hpp"

#include <cmath>

#include "fovea/model/cholesky.hpp"

namespace fovea::servo {
namespace {

using features::FeatureVector;
using TaskMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, features::kMaxDim,
                                 features::kMaxDim>;

// y = (Jw Jw^T)^-1 y when all singular values are above the threshold, which is so when Jw Jw^T less the
// threshold's square has a Cholesky factor; then nothing is damped. Else false, y untouched.
bool SolveUndamped(const TaskMatrix& A, double threshold2, FeatureVector& y) noexcept {
  TaskMatrix L = A;
  L.diagonal().array() -= threshold2;
  model::FactorCholesky(L);
  for (Eigen::Index i = 0; i < L.rows(); ++i) {
    if (!(L(i, i) > 0.0)) {
      return false;
    }
  }
  L = A;
  model::FactorCholesky(L);
  model::SolveLower(L, y);
  model::SolveLowerTransposed(L, y);
  return true;
}

// y = g(Jw Jw^T) y. Returns the smallest singular value.
double SolveDamped(const TaskJacobian& Jw, double threshold2, FeatureVector& y) noexcept {
  RowSvd svd;
  ComputeRowSvd(Jw, svd);
  const FeatureVector right = y;
  y.setZero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(svd.rows); ++i) {
    double damped2 = svd.sigma[i] * svd.sigma[i];
    if (damped2 < threshold2) {
      // sigma^2 + damping^2, as one square
      const double half = 0.5 * (1.0 + damped2 / threshold2);
      damped2 = threshold2 * half * half;
    }
    double share = 0.0;
    for (Eigen::Index k = 0; k < y.size(); ++k) {
      share += svd.u[i][static_cast<std::size_t>(k)] * right[k];
    }
    for (Eigen::Index k = 0; k < y.size(); ++k) {
      y[k] += svd.u[i][static_cast<std::size_t>(k)] * (share / damped2);
    }
  }
  return svd.Smallest();
}

}  // namespace

void ResolveDamped(const DampingConfig& config, const MotionTask& task, DampedMotion& motion) noexcept {
  const Eigen::Index m = task.J.rows();
  const Eigen::Index n = task.J.cols();
  TaskJacobian Jw = task.J;
  model::VecN shrink(n);  // diagonal of W^-1/2
  for (Eigen::Index k = 0; k < n; ++k) {
    shrink[k] = 1.0 / std::sqrt(task.weight[k]);
    for (Eigen::Index i = 0; i < m; ++i) {
      Jw(i, k) *= shrink[k];
    }
  }
  TaskMatrix A(m, m);
  A = Jw.lazyProduct(Jw.transpose());
  const double relative2 = config.threshold * config.threshold * A.trace() / static_cast<double>(m);
  const double threshold2 = relative2 + config.threshold_floor * config.threshold_floor;
  motion.threshold = std::sqrt(threshold2);
  motion.sigma_min = motion.threshold;

  FeatureVector y = task.v;
  y -= task.J.lazyProduct(task.dq_0);
  if (!SolveUndamped(A, threshold2, y)) {
    motion.sigma_min = SolveDamped(Jw, threshold2, y);
  }
  const model::VecN x = Jw.transpose().lazyProduct(y);
  motion.dq = task.dq_0;
  for (Eigen::Index k = 0; k < n; ++k) {
    motion.dq[k] += shrink[k] * x[k];
  }
  motion.finite = motion.dq.allFinite() && std::isfinite(motion.threshold);
  if (!motion.finite) {
    motion.dq.setZero();
  }
}

}  // namespace fovea::servo
