// Stage 2, visual law: from the feature's error to the task that takes it away.
//
//   ds_cmd = lambda e - ds/dt of the target's own motion          e = s_star - s
//   J_s dq = ds_cmd                                               J_s = L_s J_C
//
// (Chaumette and Hutchinson, Visual servo control I and II, 2006 and 2007.) The joint velocities follow in
// the next stage, where the limits are known (resolve_motion.hpp); what the feature leaves free goes to the
// posture and its like.
#pragma once

#include "fovea/features/feature_state.hpp"
#include "fovea/servo/resolve_motion.hpp"
#include "fovea/servo/servo_config.hpp"

namespace fovea::servo {

struct VisualLawOutput {
  features::FeatureVector e;
  features::FeatureVector ds_cmd;  // wanted ds/dt owing to the camera's motion
  MotionTask task;                 // before smooth start and limits
};

// `J_C` [6 x num_joints] body Jacobian of the camera, `q` [num_joints]. Real-time: yes.
void VisualLaw(const LawConfig& config, const model::ArmModel& arm, const features::FeatureState& feature,
               const model::Mat6N& J_C, const model::VecN& q, VisualLawOutput& output) noexcept;

// Share of the wanted feature motion `ds_cmd` that the joint velocity `dq` brings about: its projection on
// ds_cmd; 1 for all of it, 0 for none. 1 when nothing is wanted. Real-time: yes.
[[nodiscard]] double Progress(const features::FeatureState& feature, const features::FeatureVector& ds_cmd,
                              const model::Mat6N& J_C, const model::VecN& dq) noexcept;

}  // namespace fovea::servo
