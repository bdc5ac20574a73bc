// SPDX-License-Identifier: Apache-2.0
// The servo's state from tick to tick, and the intermediate results of a tick.
#pragma once

#include <cstdint>

#include "firmware/core/control/reach_watch.hpp"
#include "firmware/core/control/resolve_motion.hpp"
#include "firmware/core/control/visual_law.hpp"
#include "firmware/core/control/way_to_goal.hpp"
#include "firmware/core/estimate/contact.hpp"
#include "firmware/core/estimate/encoder_watch.hpp"
#include "firmware/core/estimate/eye_watch.hpp"
#include "firmware/core/estimate/predict.hpp"
#include "firmware/core/estimate/push.hpp"
#include "firmware/core/features/feature_state.hpp"
#include "firmware/core/guard/fault_stop.hpp"
#include "firmware/core/guard/known_clearances.hpp"
#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/motion_laws/motion_law.hpp"
#include "firmware/core/moves/follow_motion.hpp"
#include "firmware/core/task/check_inputs.hpp"
#include "firmware/core/task/modes.hpp"
#include "firmware/core/task/tune.hpp"
#include "firmware/core/trajectory/plan_part.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::task {

// Intermediate terms, grouped by the stage that computes them; each is overwritten in its turn.
struct ServoState {
  std::uint64_t tick = 0;

  // keys that change in motion
  TuningState tuning;

  // check inputs
  std::int64_t now_ns = 0;  // the time for which this tick computes
  InputState inputs;
  model::VecN q;            // [num_joints] sound
  model::VecN dq;           // [num_joints] sound
  model::VecN tau_applied;  // [num_joints] sound

  // model
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  model::Pose X_BC;
  model::Mat6N J_C;
  model::LinearJacobian J_E_B;

  // contact
  estimate::ContactState contact;
  estimate::PushWatch push;
  estimate::EncoderWatch encoders;
  bool blind = false;  // a joint's encoder hangs

  // predict
  hal::Intake intake = hal::Intake::kNone;  // of this tick's measurement
  estimate::PredictState predict;
  estimate::Prediction prediction;

  // modes
  estimate::EyeWatch eye;
  ModeState mode;
  std::int32_t fault_joint = -1;
  std::int64_t mode_since_ns = 0;
  std::int64_t track_since_ns = 0;  // the last entry into Track from Hold
  control::ReachWatch reach;

  // visual law
  bool feature_valid = false;
  features::FeatureState feature;
  model::Mat3 R_BC_held = model::Mat3::Identity();  // the camera's orientation when Track began
  control::VisualLawOutput law;
  control::WayToGoal way;          // the law, or a plan to the target
  trajectory::PlanReceiver plans;  // the last plan that was asked for
  control::PlanStep plan_step;     // in way kPlan, and on a horizon
  bool on_horizon = false;         // of a predictive law, in this tick

  // guard
  control::ResolvedMotion resolved;
  trajectory::Reference reference;
  bool holds = false;            // the reference has started at the arm's state
  moves::MotionState motion;     // mode Move
  guard::KnownClearances known;  // from the proofs before
  hal::LimitSet limits = 0;

  // motion law and clamp
  motion_laws::MotionLawState law_state;
  model::VecN tau;
  model::VecN tau_before;  // the command of the previous tick
  guard::FaultStop stop;   // in Fault
};

}  // namespace fovea::task
