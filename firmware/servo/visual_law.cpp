#include "fovea/servo/visual_law.hpp"

namespace fovea::servo {
void VisualLaw(const LawConfig& config, const model::ArmModel& arm, const features::FeatureState& feature,
               const model::Mat6N& J_C, const model::VecN& q, VisualLawOutput& output) noexcept {
  output.e = feature.s_star - feature.s;
  output.ds_cmd = config.lambda * output.e - feature.ds_dt_target;
  output.task.J = feature.L_s.lazyProduct(J_C);
  output.task.v = output.ds_cmd;
  output.task.dq_0 = FreeWish(config, arm, q, J_C);
  output.task.weight.setOnes(q.size());
}

double Progress(const features::FeatureState& feature, const features::FeatureVector& ds_cmd,
                const model::Mat6N& J_C, const model::VecN& dq) noexcept {
  const double wanted2 = ds_cmd.squaredNorm();
  if (wanted2 == 0.0) {
    return 1.0;
  }
  const model::Vec6 V_BC_C = J_C.lazyProduct(dq);
  const features::FeatureVector ds = feature.L_s.lazyProduct(V_BC_C);
  return ds_cmd.dot(ds) / wanted2;
}

}  // namespace fovea::servo
