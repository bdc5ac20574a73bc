// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/motion_laws/motion_law.hpp"

#include "firmware/core/model/ready_inertia.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"
#include "firmware/core/trajectory/smooth_step.hpp"

namespace fovea::motion_laws {
namespace {

static_assert(
    [] {
      for (std::size_t i = 0; i < kMotionLaws.size(); ++i) {
        if (static_cast<std::size_t>(kMotionLaws[i].kind) != i) {
          return false;
        }
      }
      return true;
    }(),
    "a law is found by its place in the list");

void TorqueOf(config::MotionLawKind kind, const config::MotionLawConfig& config,
              const MotionLawInputs& inputs, MotionLawState& state, model::VecN& tau) noexcept {
  EntryOf(kind).torque(config, inputs, state, tau);
}

// The remaining share of the step of the last change of laws.
double Fade(const config::MotionLawConfig& config, const MotionLawState& state) noexcept {
  return 1.0 - trajectory::SmoothStep(state.since_change_s / config.change_s);
}

}  // namespace

void MotionLawState::Reset(config::MotionLawKind law, int num_joints) noexcept {
  kind = law;
  integral.setZero(num_joints);
  cut.setZero(num_joints);
  step.setZero(num_joints);
  since_change_s = 0.0;
}

Fitness FitnessOf(const config::MotionLawConfig& config, const model::ArmModel& arm,
                  config::MotionLawKind kind) noexcept {
  const MotionLawEntry& law = EntryOf(kind);
  if (arm.num_joints < law.joints_min) {
    return {Unfit::kTooFewJoints};
  }
  const model::VecN inertia = model::InertiaAtReady(arm).held;
  Fitness fastest;
  for (int i = 0; i < arm.num_joints; ++i) {
    const double damping = law.has_springs ? config.k_v[static_cast<std::size_t>(i)] / inertia[i]
                                           : 2.0 * config.zeta * config.omega_n;
    if (!(damping <= fastest.damping)) {
      fastest = {Unfit::kNone, i, damping};
    }
  }
  if (!(fastest.damping <= law.damping_most)) {
    fastest.why = Unfit::kDampedTooFast;
  }
  return fastest;
}

void MotionLaw(const config::MotionLawConfig& config, const MotionLawInputs& inputs, MotionLawState& state,
               model::VecN& tau) noexcept {
  TorqueOf(state.kind, config, inputs, state, tau);
  tau += Fade(config, state) * state.step;
  if (state.since_change_s < config.change_s) {
    state.since_change_s += hal::kTickPeriodS;
  }
}

void ChangeMotionLaw(const config::MotionLawConfig& config, const MotionLawInputs& inputs,
                     config::MotionLawKind kind, MotionLawState& state) noexcept {
  if (kind == state.kind) {
    return;
  }
  model::VecN before;
  model::VecN after;
  TorqueOf(state.kind, config, inputs, state, before);
  before += Fade(config, state) * state.step;
  state.integral.setZero();  // its torque is in the step now
  TorqueOf(kind, config, inputs, state, after);
  state.kind = kind;
  state.step = before - after;
  state.since_change_s = 0.0;
}

}  // namespace fovea::motion_laws
