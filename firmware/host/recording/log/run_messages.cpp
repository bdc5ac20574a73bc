// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/run_messages.hpp"

#include <array>

#include "firmware/core/model/rotation.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "fovea/hal/events.hpp"
#include "fovea/run.pb.h"

namespace fovea::log {

Setup SetupMessage(const RunSetup& run) {
  Setup setup;
  setup.set_name(run.name);
  for (int i = 0; i < run.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Joint& joint = *setup.add_joints();
    joint.set_name(run.joint_names[k]);
    joint.set_prismatic(run.arm.joints[k].type == model::JointType::kPrismatic);
    joint.set_q_min(run.arm.joints[k].q_min);
    joint.set_q_max(run.arm.joints[k].q_max);
    joint.set_dq_max(run.arm.joints[k].dq_max);
    joint.set_tau_max(run.arm.joints[k].tau_max);
  }
  setup.set_lambda(run.lambda);
  setup.set_target_radius(run.target_radius);
  const features::TargetFeature& feature = run.feature;
  setup.set_target(features::kTargetNames[static_cast<std::size_t>(feature.target)]);
  setup.set_feature(features::kFormNames[static_cast<std::size_t>(feature.form)]);
  for (int i = 0; feature.SeesOrientation() && i < feature.corners.num_corners; ++i) {
    setup.add_corners(feature.corners.corners[static_cast<std::size_t>(i)].x());
    setup.add_corners(feature.corners.corners[static_cast<std::size_t>(i)].y());
  }
  const std::array<double, 4> q_CO_star = model::QuaternionOf(feature.R_CO_star);
  setup.mutable_q_co_star()->Add(q_CO_star.begin(), q_CO_star.end());
  setup.set_target_moves(run.target_moves);
  const model::Vec3& goal = feature.p_CO_C_star;
  setup.mutable_p_co_c_star()->Add(goal.data(), goal.data() + 3);
  setup.set_workspace_radius(run.workspace_radius);
  setup.set_duration_s(run.duration_s);
  setup.set_f_px(run.intrinsics.f_u_px);
  setup.set_c_u_px(run.intrinsics.c_u_px);
  setup.set_c_v_px(run.intrinsics.c_v_px);
  setup.set_start_ns(run.start_ns);
  for (int i = 0; i < hal::kNumLimits; ++i) {
    setup.add_limits(hal::Name(static_cast<hal::Limit>(i)));
  }
  return setup;
}

TickTimes TickTimesMessage(const linux_rt::DurationHistogram& ticks) {
  TickTimes times;
  ticks.ForEach([&times](std::int64_t upper_ns, std::uint64_t count) {
    times.add_upper_ns(static_cast<std::uint64_t>(upper_ns));
    times.add_counts(count);
  });
  return times;
}

Truth TruthMessage(const TruthSample& sample) {
  Truth truth;
  truth.set_stamp_ns(sample.stamp_ns);
  truth.mutable_p_bo()->Add(sample.p_BO.begin(), sample.p_BO.end());
  truth.mutable_p_bc()->Add(sample.p_BC.begin(), sample.p_BC.end());
  truth.set_error_px(sample.error_px);
  truth.set_error_mm(sample.error_mm);
  truth.mutable_q_bo()->Add(sample.q_BO.begin(), sample.q_BO.end());
  return truth;
}

}  // namespace fovea::log
