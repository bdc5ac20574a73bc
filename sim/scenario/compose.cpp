// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/compose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/config/input_error.hpp"
#include "sim/camera/mix_bits.hpp"
#include "sim/scenario/roll_pitch_yaw.hpp"
#include "sim/scenario/solids.hpp"
#include "sim/scenario/to_vector.hpp"

namespace fovea::sim {
using config::InputError;

Eigen::Isometry3d CameraMount(const Scenario& s) {
  Eigen::Isometry3d X_EC = Eigen::Isometry3d::Identity();
  X_EC.linear() = RollPitchYaw(s.camera.calibration.mount_rpy_deg).toRotationMatrix();
  X_EC.translation() = ToVector(s.camera.calibration.mount_xyz);
  return X_EC;
}

void CheckSizes(const Scenario& s, const robots::Robot& robot) {
  struct PerJoint {
    const char* key;
    std::size_t size;
    bool may_be_empty;
  };
  for (const PerJoint& list :
       {PerJoint{"arm.q_start", s.arm.q_start.size(), false},
        {"arm.dq_start", s.arm.dq_start.size(), true},
        {"arm.spring", s.arm.spring.size(), true},
        {"arm.viscous", s.arm.viscous.size(), true},
        {"arm.coulomb", s.arm.coulomb.size(), true},
        {"arm.rotor_inertia", s.arm.rotor_inertia.size(), true},
        {"faults.push", static_cast<std::size_t>(s.faults.bench.push.tau.size()), true},
        {"motion.from", s.motion.from.size(), true},
        {"motion.velocity", s.motion.velocity.size(), true},
        {"motion.amplitude", s.motion.amplitude.size(), true},
        {"motion.multiple", s.motion.multiple.size(), true}}) {
    const bool fits = static_cast<int>(list.size) == robot.model.num_joints;
    if (!fits && !(list.size == 0 && list.may_be_empty)) {
      throw InputError(fmt::format("{} has {} entries, arm \"{}\" has {} joints", list.key, list.size,
                                   robot.name, robot.model.num_joints));
    }
  }
}

void CheckFriction(const Scenario& s) {
  constexpr double kRounding = 1e-9;
  const double servo = s.servo.config.motion_law.friction_compensation;
  if (servo + s.arm.friction_compensation > 1.0 + kRounding) {
    throw InputError(
        fmt::format("servo.friction_compensation = {} is not allowed with arm.friction_compensation = {}: "
                    "their sum may be at most 1, because more would drive the joints",
                    servo, s.arm.friction_compensation));
  }
}

void SetJoints(const Scenario& s, robots::Robot& robot, SimRobot& sim_robot) {
  for (int i = 0; i < robot.model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    model::Joint& joint = robot.model.joints[k];
    joint.spring = s.arm.spring.empty() ? 0.0 : s.arm.spring[k];
    joint.viscous = s.arm.viscous.empty() ? joint.viscous : s.arm.viscous[k];
    joint.coulomb = s.arm.coulomb.empty() ? joint.coulomb : s.arm.coulomb[k];
    joint.rotor_inertia = s.arm.rotor_inertia.empty() ? joint.rotor_inertia : s.arm.rotor_inertia[k];
    for (SimLink& link : sim_robot.links) {
      if (link.dof == i) {
        link.viscous = joint.viscous;
        link.coulomb = joint.coulomb;
        link.rotor_inertia = joint.rotor_inertia;
      }
    }
  }
}

void AddLoad(const model::Load& load, SimRobot& robot) {
  if (!(load.mass > 0.0)) {
    return;
  }
  SimLink link;
  link.name = "fovea/load";
  link.parent = robot.tip;
  link.mass = load.mass;
  link.X_LCom.translation() = load.p_ECom;
  link.I_Com = load.I_Com_E;
  robot.links.push_back(link);
}

// InputError: a joint or the hand starts faster than its limit.
void CheckStartSpeed(const Eigen::VectorXd& dq, const model::ArmModel& arm, const model::ArmPoses& poses,
                     const config::GuardConfig& guard) {
  for (int i = 0; i < arm.num_joints; ++i) {
    const double most = guard.joint_velocity_fraction * arm.joints[static_cast<std::size_t>(i)].dq_max;
    if (std::fabs(dq[i]) > most) {
      throw InputError(
          fmt::format("arm.dq_start[{}] = {} is not allowed: joint {} may start with at most {:.3g}, by "
                      "safety.joint_velocity_fraction",
                      i, dq[i], i + 1, most));
    }
  }
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, poses.X_BE.p, J);
  const double speed = J.lazyProduct(dq).norm();
  const double turn = model::AngularVelocity(arm, poses, dq).norm();
  if (speed > guard.cartesian_speed || turn > guard.rotation_speed) {
    throw InputError(
        fmt::format("arm.dq_start is not allowed: the hand starts with {:.3g} m/s and {:.3g} rad/s; "
                    "safety.cartesian_speed is {} m/s, safety.rotation_speed {} rad/s",
                    speed, turn, guard.cartesian_speed, guard.rotation_speed));
  }
}

void CheckStart(const Scenario& s, const robots::Robot& robot) {
  const std::vector<double>& q = s.arm.q_start;
  for (std::size_t i = 0; i < q.size(); ++i) {
    const model::Joint& joint = robot.model.joints[i];
    if (q[i] < joint.q_min || q[i] > joint.q_max) {
      throw InputError(fmt::format("arm.q_start[{}] = {} is not allowed: joint {} reaches from {} to {}", i,
                                   q[i], i + 1, joint.q_min, joint.q_max));
    }
  }
  const config::GuardConfig& guard = s.servo.config.guard;
  model::ArmPoses poses;
  const Eigen::Map<const Eigen::VectorXd> q_start(q.data(), robot.model.num_joints);
  model::ComputePoses(robot.model, q_start, poses);
  if (!s.arm.dq_start.empty()) {
    CheckStartSpeed(ToVectorX(s.arm.dq_start), robot.model, poses, guard);
  }
  const double radius = poses.X_BE.p.norm();
  if (radius > guard.workspace_radius - guard.workspace_margin) {
    throw InputError(
        fmt::format("arm.q_start is not allowed: the end effector is {:.3f} m from the base, beyond "
                    "safety.workspace_radius = {} m minus safety.workspace_margin = {} m",
                    radius, guard.workspace_radius, guard.workspace_margin));
  }
}

CommandedMotion MakeMotion(const Scenario& s) {
  const auto joints = [](const std::vector<double>& values) {
    hal::JointArray array{};
    std::copy(values.begin(), values.end(), array.begin());
    return array;
  };
  const auto& m = s.motion;
  if (m.kind == "circle") {
    if (!(ToVector(m.normal).norm() > 0.0)) {
      throw config::InputError("motion.normal = [0, 0, 0] is not allowed: a plane's normal must not be zero");
    }
    const Eigen::Vector3d normal = ToVector(m.normal).normalized();
    const Eigen::Vector3d aside =
        std::fabs(normal.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
    CommandedCircle circle;
    circle.centre = ToVector(m.centre);
    circle.across = aside.cross(normal).normalized();
    circle.down = -normal.cross(circle.across);
    circle.hand = RollPitchYaw(m.hand_rpy_deg);
    circle.radius = m.radius;
    circle.rate_hz = m.rate_hz;
    circle.lead_s = m.lead_s;
    return circle;
  }
  if (m.kind == "home") {
    return CommandedHome{};
  }
  if (m.kind == "waves") {
    hal::JointArray multiple{};
    multiple.fill(1.0);
    return CommandedWaves{joints(m.from.empty() ? s.arm.q_start : m.from), joints(m.amplitude),
                          m.multiple.empty() ? multiple : joints(m.multiple), m.omega};
  }
  return CommandedJoints{joints(m.from.empty() ? s.arm.q_start : m.from), joints(m.velocity),
                         joints(m.amplitude), m.omega};
}

RenderScene MakeRenderScene(const Scenario& s, const SimRobot& robot) {
  RenderScene scene;
  scene.bench = ShareBench(s.target.clutter, BenchBoxes(s));
  scene.robot = robot;
  scene.has_eye = s.camera.enabled;
  scene.X_EC = CameraMount(s);
  scene.target = MakeTargetShape(config::MakeTarget(s.target));
  scene.target_R_BO = RollPitchYaw(s.target.rpy_deg).toRotationMatrix();
  scene.target_colour = ToVector(s.target.colour).cast<float>();
  scene.light = s.camera.light;
  return scene;
}

std::uint64_t SeedOf(const Scenario& s, RandomStream stream) {
  constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15U;  // so that seed 0 does not hash to 0
  return MixBits((static_cast<std::uint64_t>(s.run.seed) << 8U) + static_cast<std::uint64_t>(stream) +
                 kGoldenRatio);
}

Pinhole MakeScenarioPinhole(const Scenario& s) {
  const vision::Intrinsics& in = s.camera.calibration.intrinsics;
  Pinhole pinhole = MakePinhole(in.width_px, in.height_px, s.camera.hfov_deg * kRadPerDeg);
  const std::array<double, 4> given{in.f_u_px, in.f_v_px, in.c_u_px, in.c_v_px};
  if (given == std::array<double, 4>{}) {
    return pinhole;
  }
  if (std::count(given.begin(), given.end(), 0.0) > 0) {
    throw InputError(fmt::format(
        "camera.f_u_px, f_v_px, c_u_px, c_v_px = {}, {}, {}, {} is not allowed: set all four or none",
        in.f_u_px, in.f_v_px, in.c_u_px, in.c_v_px));
  }
  const auto is_in = [](double px, int size_px) { return px >= 0.0 && px <= size_px - 1; };
  if (!is_in(in.c_u_px, in.width_px) || !is_in(in.c_v_px, in.height_px)) {
    throw InputError(
        fmt::format("camera.c_u_px, c_v_px = {}, {} is not allowed: outside the picture of {} x {} px",
                    in.c_u_px, in.c_v_px, in.width_px, in.height_px));
  }
  pinhole.f_px = in.f_u_px;
  pinhole.c_u_px = in.c_u_px;
  pinhole.c_v_px = in.c_v_px;
  pinhole.aspect = in.f_v_px / in.f_u_px;
  return pinhole;
}

Lens MakeScenarioLens(const Scenario& s) {
  const std::vector<double>& k = s.camera.calibration.lens;
  return {k[0], k[1], k[2], k[3], k[4]};
}

Shutter MakeScenarioShutter(const Scenario& s) {
  return {static_cast<std::int64_t>(s.camera.exposure_ms * 1e6), s.camera.sub_exposures,
          1e3 * s.camera.calibration.row_time_us};
}

SensorConfig MakeScenarioSensor(const Scenario& s) {
  SensorConfig config{.read_sigma = s.camera.noise_sigma,
                      .shot_noise = s.camera.shot_noise,
                      .gain = s.camera.gain,
                      .saturation = s.camera.saturation};
  if (s.camera.vignetting) {
    config.vignetting = MakeScenarioPinhole(s);
  }
  config.mosaic = camera::FormatOf(s.camera.bayer);
  return config;
}

void CheckLens(const Scenario& s) {
  const Lens lens = MakeScenarioLens(s);
  const Pinhole pinhole = MakeScenarioPinhole(s);
  try {
    if (NeedsLensMap(lens, pinhole)) {
      const LensMap map(lens, pinhole);
    }
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format(
        "camera.lens = [{}, {}, {}, {}, {}] is not allowed with focal lengths of {:.6g} and {:.6g} px: {}",
        lens.k1, lens.k2, lens.p1, lens.p2, lens.k3, pinhole.f_px, pinhole.FocalV(), error.what()));
  }
}

void CheckGoal(const Scenario& s) {
  const Pinhole pinhole = MakeScenarioPinhole(s);
  const Eigen::Vector3d goal = ToVector(s.servo.goal);
  const double u = pinhole.U(goal);
  const double v = pinhole.V(goal);
  if (!(u >= 0.0 && u <= pinhole.width_px - 1 && v >= 0.0 && v <= pinhole.height_px - 1)) {
    throw InputError(fmt::format(
        "servo.goal = [{}, {}, {}] is not allowed: it is at ({:.0f}, {:.0f}) px, outside the picture "
        "of {} x {} px",
        goal.x(), goal.y(), goal.z(), u, v, pinhole.width_px, pinhole.height_px));
  }
  const double near = s.vision.config.distance_min;
  const double far = s.vision.config.distance_max;
  if (goal.norm() < near || goal.norm() > far) {
    throw InputError(
        fmt::format("servo.goal = [{}, {}, {}] is not allowed: its distance is {:.3g} m; vision.distance_min "
                    "and vision.distance_max allow {} to {} m",
                    goal.x(), goal.y(), goal.z(), goal.norm(), near, far));
  }
}

void CheckTimes(const Scenario& s) {
  const double period_ms = 1e3 / s.camera.rate_hz;
  if (s.camera.exposure_ms > period_ms) {
    throw InputError(
        fmt::format("camera.exposure_ms = {} is not allowed: at camera.rate_hz = {} the period is {:.3g} ms",
                    s.camera.exposure_ms, s.camera.rate_hz, period_ms));
  }
  const auto& camera = s.camera.calibration;
  const double rows_ms = 1e-3 * camera.row_time_us * camera.intrinsics.height_px;
  if (rows_ms > period_ms) {
    throw InputError(
        fmt::format("camera.row_time_us = {} is not allowed: {} rows would take {:.3g} ms; at camera.rate_hz "
                    "= {} the period "
                    "is {:.3g} ms",
                    camera.row_time_us, camera.intrinsics.height_px, rows_ms, s.camera.rate_hz, period_ms));
  }
  if (s.camera.latency_ms < 0.5 * s.camera.exposure_ms) {
    throw InputError(fmt::format(
        "camera.latency_ms = {} is not allowed: it must be at least half of camera.exposure_ms = {}",
        s.camera.latency_ms, s.camera.exposure_ms));
  }
  if (const double ends_ms = 0.5 * (s.camera.exposure_ms + rows_ms); s.camera.latency_ms < ends_ms) {
    throw InputError(fmt::format(
        "camera.latency_ms = {} is not allowed: with camera.row_time_us = {} the last row's exposure "
        "ends {:.3g} ms after the stamp",
        s.camera.latency_ms, camera.row_time_us, ends_ms));
  }
  const double stale_ms = 1e3 * s.servo.config.predict.stale_s;
  if (s.camera.latency_ms >= stale_ms) {
    throw InputError(fmt::format(
        "camera.latency_ms = {} is not allowed: every measurement would be older than servo.stale_s = "
        "{} s when it arrives",
        s.camera.latency_ms, s.servo.config.predict.stale_s));
  }
}

}  // namespace fovea::sim
