#include "fovea/servo/visual_law.hpp"

#include <cmath>

namespace fovea::servo {
namespace {

using features::FeatureVector;
using features::kMaxDim;
using TaskJacobian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxDim, model::kMaxJoints>;
using TaskMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxDim, kMaxDim>;

// Cholesky factor of the symmetric positive definite `A` in its lower half, in place. A pivot that is not
// positive gives NaN, which the caller's check for finite values finds.
void FactorCholesky(TaskMatrix& A) noexcept {
  const auto n = A.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      double sum = A(i, j);
      for (Eigen::Index k = 0; k < j; ++k) {
        sum -= A(i, k) * A(j, k);
      }
      A(i, j) = i == j ? std::sqrt(sum) : sum / A(j, j);
    }
  }
}

// Solves L L^T x = b in place.
void SolveCholesky(const TaskMatrix& L, FeatureVector& x) noexcept {
  const auto n = L.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < i; ++k) {
      x[i] -= L(i, k) * x[k];
    }
    x[i] /= L(i, i);
  }
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    for (Eigen::Index k = i + 1; k < n; ++k) {
      x[i] -= L(k, i) * x[k];
    }
    x[i] /= L(i, i);
  }
}

}  // namespace

void VisualLaw(const LawConfig& config, const features::FeatureState& feature, const model::Mat6N& J_C,
               const model::VecN& q, VisualLawOutput& output) noexcept {
  const auto dim = feature.s.size();
  output.e = feature.s_star - feature.s;
  output.ds_cmd = config.lambda * output.e - feature.ds_dt_target;

  const TaskJacobian J_s = feature.L_s.lazyProduct(J_C);
  const model::VecN dq_0 =
      config.posture_gain * (model::ToVector(config.q_posture, static_cast<int>(q.size())) - q);

  // (J J^T + mu^2 I), with mu in proportion to the size of J, so that units do not matter.
  TaskMatrix A = J_s.lazyProduct(J_s.transpose());
  const double mu2 = config.damping * config.damping * A.trace() / static_cast<double>(dim);
  A.diagonal().array() += mu2;
  FactorCholesky(A);
  FeatureVector y = output.ds_cmd - J_s.lazyProduct(dq_0);
  SolveCholesky(A, y);
  output.dq_des = dq_0;
  output.dq_des += J_s.transpose().lazyProduct(y);
}

double Progress(const features::FeatureState& feature, const features::FeatureVector& ds_cmd,
                const model::Mat6N& J_C, const model::VecN& dq) noexcept {
  const double wanted2 = ds_cmd.squaredNorm();
  if (wanted2 == 0.0) {
    return 1.0;
  }
  const model::Vec6 V_BC_C = J_C.lazyProduct(dq);
  const FeatureVector ds = feature.L_s.lazyProduct(V_BC_C);
  return ds_cmd.dot(ds) / wanted2;
}

}  // namespace fovea::servo
