// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/visual_law.hpp"

#include <cmath>

#include "firmware/core/control/compress_task.hpp"

namespace fovea::control {

double GainAt(const config::LawConfig& config, double e) noexcept {
  const double step = config.lambda_near - config.lambda;
  if (config.lambda_near == 0.0 || step == 0.0) {
    return config.lambda;
  }
  return config.lambda + step / (1.0 + config.lambda_slope * e / std::fabs(step));
}

void ChooseInteraction(const config::LawConfig& config, const features::InteractionMatrix& L_s_star,
                       features::FeatureState& feature) noexcept {
  LineOf(config.law).interaction(L_s_star, feature);
}

void CommandFeature(const config::LawConfig& config, const features::FeatureState& feature,
                    const LawJoints& joints, VisualLawOutput& output) noexcept {
  output.e = feature.s_star - feature.s;
  const LawScene scene{feature, joints, output.e, GainAt(config, output.e.norm())};
  output.ds_cmd = LineOf(config.law).motion(scene) - feature.ds_dt_target;
}

void CommandJoints(const config::LawConfig& config, const model::ArmModel& arm,
                   const features::FeatureState& feature, const LawJoints& joints,
                   VisualLawOutput& output) noexcept {
  features::InteractionMatrix L = feature.L_s;
  output.task.v = output.ds_cmd;
  CompressTask(L, output.task.v);
  output.task.J = L.lazyProduct(joints.J_C);
  output.task.dq_0 = FreeWish(config, arm, joints.q, joints.J_C);
  output.task.weight.setOnes(joints.q.size());
}

void VisualLaw(const config::LawConfig& config, const model::ArmModel& arm,
               const features::FeatureState& feature, const LawJoints& joints,
               VisualLawOutput& output) noexcept {
  CommandFeature(config, feature, joints, output);
  CommandJoints(config, arm, feature, joints, output);
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

}  // namespace fovea::control
