// The fields of the servo's configuration, in the order in which they go over the line and into logs. A field
// that is added to a struct is added here, at the end of its list, so that logs stay readable that were
// written without it; messages_test.cpp knows the structs' sizes and says so.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/link/fields.hpp"

namespace fovea::link {

template <class Archive, class T>
void FeatureFields(Archive& a, T& f) noexcept {
  a.Choice(f.target, static_cast<int>(features::kTargetNames.size()));
  a.Choice(f.form, static_cast<int>(features::kFormNames.size()));
  a(f.hold_orientation);
  a(f.radius);
  a(f.side);
  a.Count(f.corners.num_corners, features::Polygon::kMost);
  for (auto& corner : f.corners.corners) {
    Entries(a, corner);
  }
  Entries(a, f.p_CO_C_star);
  Entries(a, f.R_CO_star);
}

template <class Archive, class T>
void PredictFields(Archive& a, T& p) noexcept {
  a(p.enabled);
  a(p.target_jerk);
  a(p.target_turn);
  a(p.gate_sigma);
  a.Int(p.gate_rejects_max);
  a.Int(p.accepted_min);
  a(p.stale_s);
  a(p.coast_s);
  a(p.target_speed_max);
  a(p.target_acceleration_max);
  a(p.target_turn_max);
  Entries(a, p.target_region.low);
  Entries(a, p.target_region.high);
  a(p.stuck_shift);
  a(p.stamp_sigma);
  a(p.mount_shift_sigma);
  a(p.mount_turn_sigma);
  a(p.scale_sigma);
  a(p.way_in_vain);
}

template <class Archive, class T>
void LawFields(Archive& a, T& l) noexcept {
  a(l.lambda);
  a(l.lambda_near);
  a(l.lambda_slope);
  a.Choice(l.interaction, static_cast<int>(config::kInteractionNames.size()));
  a(l.smooth_start_s);
  a(l.damping);
  a(l.posture_gain);
  a(l.joint_limit_gain);
  a(l.manipulability_gain);
  a(l.free_speed);
  EachOf(a, l.q_posture);
  a(l.unreachable_s);
  a(l.unreachable_progress);
}

template <class Archive, class T>
void MoveFields(Archive& a, T& m) noexcept {
  a(m.speed);
  a(m.acceleration);
  a(m.jerk);
  a(m.turn_speed);
  a(m.turn_acceleration);
  a(m.turn_jerk);
  a(m.pose_gain);
  a(m.pose_error_max);
}

template <class Archive, class T>
void MotionLawFields(Archive& a, T& m) noexcept {
  a.Choice(m.kind, config::kNumMotionLaws);
  a(m.omega_n);
  a(m.zeta);
  a(m.integral);
  a(m.integral_torque_fraction);
  EachOf(a, m.k_p);
  EachOf(a, m.k_v);
  a(m.damp_by_inertia);
  a(m.friction_compensation);
  a(m.friction_width);
  a(m.friction_slow);
  a(m.operational_damping);
  a(m.change_s);
}

template <class Archive, class T>
void GuardFields(Archive& a, T& g) noexcept {
  a(g.joint_velocity_fraction);
  a(g.joint_acceleration_fraction);
  a(g.joint_jerk_fraction);
  a(g.joint_position_margin);
  a(g.braking_fraction);
  a(g.workspace_radius);
  a(g.workspace_margin);
  a(g.workspace_deceleration);
  a(g.cartesian_speed);
  a(g.singularity_min);
  a.Count(g.obstacles.num_planes, config::Obstacles::kMost);
  a.Count(g.obstacles.num_boxes, config::Obstacles::kMost);
  for (auto& plane : g.obstacles.planes) {
    Entries(a, plane.normal);
    a(plane.distance);
  }
  for (auto& box : g.obstacles.boxes) {
    Entries(a, box.low);
    Entries(a, box.high);
  }
  a(g.view.enabled);
  a(g.view.x_min);
  a(g.view.x_max);
  a(g.view.y_min);
  a(g.view.y_max);
  a(g.sight_clearance);
  a(g.view.face_cosine_min);
  a(g.hand_clearance);
  a.Count(g.hand.num_balls, config::HandShape::kMost);
  for (auto& ball : g.hand.balls) {
    Entries(a, ball.p_EP);
    a(ball.radius);
  }
  a(g.link_radius);
}

template <class Archive, class T>
void SafetyFields(Archive& a, T& s) noexcept {
  a(s.torque_fraction);
  a(s.torque_rate_fraction);
  a.Int(s.arm_lost_ticks);
  a.Int(s.non_finite_ticks);
  a.Int(s.missed_ticks);
  a.Int(s.boot_ticks);
  a(s.boot_velocity);
  a(s.setpoint_jump);
  a(s.following_error);
  a(s.contact_torque_fraction);
  a(s.contact_gain);
  a(s.fault_damping);
  a(s.brake_velocity);
  a(s.brake_after_s);
  a(s.encoder_quantum);
  a(s.stiction_fraction);
  a(s.motion_error);
  a.Int(s.frozen_ticks);
  a(s.carried_torque_fraction);
}

// Calls `visit(name, fields)` for each part of `c` but the arm, in their order; `fields(archive)` goes
// through the part's fields.
template <class Config, class Visit>
void EachSection(Config& c, const Visit& visit) noexcept {
  visit("mount", [&c](auto& a) { PoseFields(a, c.X_EC); });
  visit("feature", [&c](auto& a) { FeatureFields(a, c.feature); });
  visit("auto_track", [&c](auto& a) { a(c.auto_track); });
  visit("predict", [&c](auto& a) { PredictFields(a, c.predict); });
  visit("law", [&c](auto& a) { LawFields(a, c.law); });
  visit("move", [&c](auto& a) { MoveFields(a, c.move); });
  visit("motion_law", [&c](auto& a) { MotionLawFields(a, c.motion_law); });
  visit("guard", [&c](auto& a) { GuardFields(a, c.guard); });
  visit("safety", [&c](auto& a) { SafetyFields(a, c.safety); });
}

template <class Archive, class T>
void ServoFields(Archive& a, T& c) noexcept {
  EachSection(c, [&a](const char*, const auto& fields) { fields(a); });
}

template <class Archive, class T>
void ArmFields(Archive& a, T& arm) noexcept {
  a.Count(arm.num_joints, model::kMaxJoints);
  for (auto& j : arm.joints) {
    a.Choice(j.type, 2);
    PoseFields(a, j.X_PJ);
    a(j.q_min);
    a(j.q_max);
    a(j.dq_max);
    a(j.ddq_max);
    a(j.dddq_max);
    a(j.tau_max);
    a(j.dtau_max);
    a(j.viscous);
    a(j.coulomb);
    a(j.spring);
  }
  for (auto& link : arm.links) {
    a(link.mass);
    Entries(a, link.p_LiCom);
    Entries(a, link.I_Com_Li);
  }
  PoseFields(a, arm.X_LnE);
  Entries(a, arm.g_B);
  EachOf(a, arm.q_ready);
}

}  // namespace fovea::link
