// What a configuration must satisfy before the task takes it.
#include <cmath>
#include <memory>

#include "firmware/core/features/hold_orientation.hpp"

#include "firmware/core/task/servo_task.hpp"

namespace fovea::task {
namespace {

using hal::Status;
using hal::StatusCode;

struct Range {
  double value;
  double min;
  double max;
  const char* where;
};

// True when the value is finite and inside; NaN fails.
bool Holds(const Range& range) noexcept { return range.value >= range.min && range.value <= range.max; }

bool IsPositive(double x) noexcept { return x > 0.0 && std::isfinite(x); }

Status CheckArmModel(const model::ArmModel& arm) noexcept {
  if (arm.num_joints < 1 || arm.num_joints > model::kMaxJoints) {
    return Status(StatusCode::kInvalidArgument, "arm.num_joints");
  }
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = arm.joints[k];
    const model::LinkInertia& link = arm.links[k];
    if (!(joint.q_min < joint.q_max) || !std::isfinite(joint.q_min) || !std::isfinite(joint.q_max)) {
      return Status(StatusCode::kOutOfRange, "joint position range");
    }
    if (!IsPositive(joint.dq_max) || !IsPositive(joint.ddq_max) || !IsPositive(joint.dddq_max)) {
      return Status(StatusCode::kOutOfRange, "joint velocity, acceleration or jerk limit");
    }
    if (!IsPositive(joint.tau_max) || !IsPositive(joint.dtau_max)) {
      return Status(StatusCode::kOutOfRange, "joint torque limit");
    }
    if (!IsPositive(link.mass) || !link.p_LiCom.allFinite() || !link.I_Com_Li.allFinite()) {
      return Status(StatusCode::kOutOfRange, "link inertia");
    }
    if (!joint.X_PJ.p.allFinite() || !joint.X_PJ.R.allFinite()) {
      return Status(StatusCode::kNonFinite, "joint frame");
    }
  }
  return Status::Ok();
}

}  // namespace

Status ServoTask::Init(const config::ServoConfig& config) noexcept {
  if (const Status status = CheckArmModel(config.arm); !status.ok()) {
    return status;
  }
  const double huge = 1e6;
  const Range ranges[] = {
      {config.feature.radius, 1e-4, 10.0, "target.diameter"},
      {config.feature.p_CO_C_star.z(), config.feature.radius, 100.0, "servo.goal"},
      {config.predict.target_jerk, 0.0, huge, "servo.target_jerk"},
      {config.predict.target_turn, 0.0, huge, "servo.target_turn"},
      {config.predict.gate_sigma, 1.0, huge, "servo.gate_sigma"},
      {config.predict.stale_s, 1e-3, config.predict.coast_s, "servo.stale_s"},
      {config.predict.coast_s, 1e-3, 0.5 * huge, "servo.coast_s"},
      {config.predict.target_speed_max, 0.0, huge, "servo.target_speed_max"},
      {config.predict.target_acceleration_max, 0.0, huge, "servo.target_acceleration_max"},
      {config.predict.target_turn_max, 0.0, huge, "servo.target_turn_max"},
      {config.predict.stuck_shift, 1e-6, huge, "servo.stuck_shift_px"},
      {config.predict.way_in_vain, 1e-3, huge, "servo.way_in_vain"},
      {config.predict.stamp_sigma, 0.0, 1.0, "servo.stamp_sigma"},
      {config.predict.mount_shift_sigma, 0.0, 1.0, "servo.mount_shift_sigma"},
      {config.predict.mount_turn_sigma, 0.0, 1.0, "servo.mount_turn_sigma"},
      {config.predict.scale_sigma, 0.0, 1.0, "servo.scale_sigma"},
      {config.law.lambda, 0.0, 20.0, "servo.lambda"},
      {config.law.lambda_near, 0.0, 20.0, "servo.lambda_near"},
      {config.law.lambda_slope, 0.0, huge, "servo.lambda_slope"},
      {config.law.smooth_start_s, 1e-3, huge, "servo.smooth_start_s"},
      {config.law.damping, 1e-6, 1.0, "servo.damping"},
      {config.law.posture_gain, 0.0, 100.0, "servo.posture_gain"},
      {config.law.joint_limit_gain, 0.0, 100.0, "servo.joint_limit_gain"},
      {config.law.manipulability_gain, 0.0, 100.0, "servo.manipulability_gain"},
      {config.law.free_speed, 1e-6, 100.0, "servo.free_speed"},
      {config.law.unreachable_s, 1e-3, huge, "servo.unreachable_s"},
      {config.law.unreachable_progress, 0.0, 1.0, "servo.unreachable_progress"},
      {config.motion_law.omega_n, 0.1, 300.0, "servo.omega_n"},
      {config.motion_law.zeta, 0.1, 10.0, "servo.zeta"},
      {config.motion_law.integral, 0.0, 100.0, "servo.integral"},
      {config.motion_law.integral_torque_fraction, 0.0, 1.0, "servo.integral_torque_fraction"},
      {config.motion_law.friction_compensation, 0.0, 1.0, "servo.friction_compensation"},
      {config.motion_law.friction_width, 1e-9, 10.0, "servo.friction_width"},
      {config.motion_law.friction_slow, 1e-9, 10.0, "servo.friction_slow"},
      {config.motion_law.operational_damping, 1e-9, 1.0, "servo.operational_damping"},
      {config.motion_law.change_s, 1e-3, 10.0, "servo.change_s"},
      {config.guard.joint_velocity_fraction, 1e-3, 1.0, "safety.joint_velocity_fraction"},
      {config.guard.joint_acceleration_fraction, 1e-3, 1.0, "safety.joint_acceleration_fraction"},
      {config.guard.joint_jerk_fraction, 1e-3, 1.0, "safety.joint_jerk_fraction"},
      {config.guard.joint_position_margin, 0.0, 1.0, "safety.joint_position_margin"},
      {config.guard.braking_fraction, 1e-3, 0.9, "safety.braking_fraction"},
      {config.guard.workspace_radius, 1e-2, 1000.0, "safety.workspace_radius"},
      {config.guard.workspace_margin, 0.0, config.guard.workspace_radius, "safety.workspace_margin"},
      {config.guard.workspace_deceleration, 1e-2, 100.0, "safety.workspace_deceleration"},
      {config.guard.cartesian_speed, 1e-3, huge, "safety.cartesian_speed"},
      {config.guard.singularity_min, 0.0, 1.0, "safety.singularity_min"},
      {config.guard.sight_clearance, 0.0, 10.0, "safety.sight_clearance"},
      {config.guard.hand_clearance, 0.0, 10.0, "safety.hand_clearance"},
      {config.guard.link_radius, 0.0, 10.0, "safety.link_radius"},
      {config.guard.view.face_cosine_min, 0.0, 1.0, "safety.face_tilt_max"},
      {config.move.speed, 1e-3, huge, "servo.move_speed"},
      {config.move.acceleration, 1e-3, huge, "servo.move_acceleration"},
      {config.move.jerk, 1e-3, huge, "servo.move_jerk"},
      {config.move.turn_speed, 1e-3, huge, "servo.turn_speed"},
      {config.move.turn_acceleration, 1e-3, huge, "servo.turn_acceleration"},
      {config.move.turn_jerk, 1e-3, huge, "servo.turn_jerk"},
      {config.move.pose_gain, 0.0, 200.0, "servo.pose_gain"},
      {config.move.pose_error_max, 1e-6, huge, "servo.pose_error_max"},
      {config.safety.torque_fraction, 1e-3, 1.0, "safety.torque_fraction"},
      {config.safety.torque_rate_fraction, 1e-3, 1.0, "safety.torque_rate_fraction"},
      {config.safety.following_error, 1e-4, 10.0, "safety.following_error"},
      {config.safety.motion_error, 1e-5, 10.0, "safety.motion_error"},
      {config.safety.contact_torque_fraction, 1e-3, huge, "safety.contact_torque_fraction"},
      {config.safety.carried_torque_fraction, 0.0, 1.0, "safety.carried_torque_fraction"},
      {config.safety.contact_gain, 0.1, 300.0, "safety.contact_gain"},
      {config.safety.fault_damping, 0.1, 100.0, "safety.fault_damping"},
      {config.safety.brake_velocity, 1e-6, 10.0, "safety.brake_velocity"},
      {config.safety.brake_after_s, 0.0, huge, "safety.brake_after_s"},
      {static_cast<double>(config.predict.gate_rejects_max), 1.0, huge, "servo.gate_rejects_max"},
      {static_cast<double>(config.predict.accepted_min), 1.0, huge, "servo.accepted_min"},
      {static_cast<double>(config.safety.arm_lost_ticks), 1.0, huge, "safety.arm_lost_ticks"},
      {static_cast<double>(config.safety.non_finite_ticks), 0.0, huge, "safety.non_finite_ticks"},
      {static_cast<double>(config.safety.frozen_ticks), 0.0, huge, "safety.frozen_ticks"},
      {static_cast<double>(config.safety.missed_ticks), 1.0, huge, "safety.missed_ticks"},
      {static_cast<double>(config.safety.boot_ticks), 1.0, huge, "safety.boot_ticks"},
      {config.safety.boot_velocity, 1e-6, huge, "safety.boot_velocity"},
      {config.safety.stiction_fraction, 0.0, 10.0, "safety.stiction_fraction"},
      {config.safety.encoder_quantum, 0.0, 0.1, "safety.encoder_quantum"},
      {config.safety.setpoint_jump, 0.0, huge, "safety.setpoint_jump"},
  };
  for (const Range& range : ranges) {
    if (!Holds(range)) {
      return Status(StatusCode::kOutOfRange, range.where);
    }
  }

  if (!config.feature.p_CO_C_star.allFinite()) {
    return Status(StatusCode::kNonFinite, "servo.goal");
  }
  if (!config.feature.IsListed()) {
    return Status(StatusCode::kInvalidArgument, "servo.feature");
  }
  features::FeatureState goal;
  if (!config.feature.ComputeAtGoal(goal)) {
    return Status(StatusCode::kOutOfRange, "servo.goal");
  }
  if (config.feature.hold_orientation) {
    features::FeatureState held;
    if (!features::HoldOrientation{}.Compute(model::Mat3::Identity(), held) || !features::Stack(held, goal)) {
      return Status(StatusCode::kInvalidArgument, "servo.hold_orientation");
    }
  }
  const config::ViewConfig& view = config.guard.view;
  if (view.enabled && !(view.x_min < view.x_max && view.y_min < view.y_max)) {
    return Status(StatusCode::kOutOfRange, "safety.view_margin_px");
  }
  const config::Box& region = config.predict.target_region;
  if (!(region.low.array() < region.high.array()).all() || !region.low.allFinite() ||
      !region.high.allFinite()) {
    return Status(StatusCode::kOutOfRange, "servo.target_region");
  }
  if (!config.X_EC.p.allFinite() || !config.X_EC.R.allFinite()) {
    return Status(StatusCode::kNonFinite, "camera.mount_xyz");
  }
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& joint = config.arm.joints[k];
    if (!(config.motion_law.k_p[k] >= 0.0 && std::isfinite(config.motion_law.k_p[k]))) {
      return Status(StatusCode::kOutOfRange, "servo.k_p");
    }
    if (!(config.motion_law.k_v[k] >= 0.0 && std::isfinite(config.motion_law.k_v[k]))) {
      return Status(StatusCode::kOutOfRange, "servo.k_v");
    }
    if (!(joint.viscous >= 0.0 && joint.coulomb >= 0.0 && joint.spring >= 0.0)) {
      return Status(StatusCode::kOutOfRange, "joint friction or spring");
    }
    if (!std::isfinite(config.law.q_posture[k])) {
      return Status(StatusCode::kNonFinite, "servo.posture");
    }
    if (!(2.0 * config.guard.joint_position_margin < joint.q_max - joint.q_min)) {
      return Status(StatusCode::kOutOfRange, "safety.joint_position_margin");
    }
  }

  const config::Obstacles& obstacles = config.guard.obstacles;
  if (obstacles.num_planes < 0 || obstacles.num_planes > config::Obstacles::kMost ||
      obstacles.num_boxes < 0 || obstacles.num_boxes > config::Obstacles::kMost) {
    return Status(StatusCode::kOutOfRange, "safety.planes or safety.boxes");
  }
  for (int i = 0; i < obstacles.num_planes; ++i) {
    const config::Plane& plane = obstacles.planes[static_cast<std::size_t>(i)];
    if (!(std::fabs(plane.normal.norm() - 1.0) < 1e-9) || !std::isfinite(plane.distance)) {
      return Status(StatusCode::kOutOfRange, "safety.planes");
    }
  }
  for (int i = 0; i < obstacles.num_boxes; ++i) {
    const config::Box& box = obstacles.boxes[static_cast<std::size_t>(i)];
    if (!(box.low.array() < box.high.array()).all() || !box.low.allFinite() || !box.high.allFinite()) {
      return Status(StatusCode::kOutOfRange, "safety.boxes");
    }
  }
  const config::HandShape& hand = config.guard.hand;
  if (hand.num_balls < 0 || hand.num_balls > config::HandShape::kMost) {
    return Status(StatusCode::kOutOfRange, "safety.tools");
  }
  for (int i = 0; i < hand.num_balls; ++i) {
    const config::HandShape::Ball& ball = hand.balls[static_cast<std::size_t>(i)];
    if (!ball.p_EP.allFinite() || !IsPositive(ball.radius)) {
      return Status(StatusCode::kOutOfRange, "safety.tools");
    }
  }
  if (config.arm.num_joints <
      motion_laws::kMotionLaws[static_cast<std::size_t>(config.motion_law.kind)].joints_min) {
    return Status(StatusCode::kInvalidArgument, "servo.motion_law");
  }

  config_ = config;
  goal_ = goal;
  std::construct_at(&state_);  // no other one for a moment: it is large, and a stack may be small
  const int n = config.arm.num_joints;
  state_.mode.track_asked = config.auto_track;
  state_.law_state.Reset(config.motion_law.kind, n);
  state_.contact.Reset(n, CarriesLoads());
  for (model::VecN* v :
       {&state_.q, &state_.dq, &state_.tau_applied, &state_.tau, &state_.tau_before, &state_.reference.q,
        &state_.reference.dq, &state_.reference.ddq, &state_.motion.off}) {
    v->setZero(n);
  }
  return Status::Ok();
}

}  // namespace fovea::task
