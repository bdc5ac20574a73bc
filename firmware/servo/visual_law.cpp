#include "fovea/servo/visual_law.hpp"

#include "fovea/model/cholesky.hpp"

namespace fovea::servo {
namespace {

using features::FeatureVector;
using features::kMaxDim;
using TaskJacobian =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxDim, model::kMaxJoints>;
using TaskMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxDim, kMaxDim>;

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
  model::FactorCholesky(A);
  FeatureVector y = output.ds_cmd - J_s.lazyProduct(dq_0);
  model::SolveCholesky(A, y);
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
