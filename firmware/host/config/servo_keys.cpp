#include "firmware/host/config/servo_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/core/task/servo_task.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"

namespace fovea::config {
namespace {

constexpr int kMostTools = 6;

void AddPredictKeys(ServoSettings& settings, KeyTable& keys) {
  config::PredictConfig& c = settings.config.predict;
  keys.Flag("servo.predict", c.enabled,
            "predict the target for every tick; false: hold the newest measurement as it came");
  keys.Number(
      "servo.target_jerk", c.target_jerk, 0.0, 1000.0, "m/s^3",
      "how fast the target's acceleration may be thought to change; larger follows faster, filters less");
  keys.Number("servo.target_turn", c.target_turn, 0.0, 1000.0, "rad/s^2",
              "square and triangle: how fast their angular velocity may be thought to change");
  keys.Number("servo.gate_sigma", c.gate_sigma, 1.0, 1000.0, "sigma",
              "a measurement further off is an outlier");
  keys.Integer("servo.gate_rejects_max", c.gate_rejects_max, 1, 1000, "",
               "so many outliers in a row, and the target is taken to have moved there");
  keys.Integer("servo.accepted_min", c.accepted_min, 1, 1000, "",
               "measurements before the target counts as known");
  keys.Number("servo.stale_s", c.stale_s, 0.001, 10.0, "s", "without a measurement for so long: Coast");
  keys.Number("servo.coast_s", c.coast_s, 0.001, 60.0, "s", "without a measurement for so long: Hold");
  keys.Number("servo.target_speed_max", c.target_speed_max, 0.0, 10.0, "m/s",
              "the target is never taken to be faster, whatever is measured");
  keys.Number("servo.target_acceleration_max", c.target_acceleration_max, 0.0, 100.0, "m/s^2",
              "nor to accelerate harder");
  keys.Number("servo.target_turn_max", c.target_turn_max, 0.0, 100.0, "rad/s", "nor to turn faster");
  keys.Numbers(
      "servo.target_region", settings.target_region, 6, 6, -100.0, 100.0, "m",
      "a measurement that puts the target outside this box is refused, and where none comes it is not "
      "believed to leave it: low x, y, z, high x, y, z, in axes of the base");
  keys.Number("servo.stuck_shift_px", settings.stuck_shift_px, 0.5, 1000.0, "px",
              "a picture that stays the same within its noise, although the hand shifted the scene in it by "
              "more than this, is no measurement");
  keys.Number(
      "servo.way_in_vain", c.way_in_vain, 0.001, 1000.0, "m",
      "the camera has gone so far, and its error got no smaller: Hold, until Track is asked for anew");
  keys.Number("servo.stamp_sigma", c.stamp_sigma, 0.0, 1.0, "s",
              "how far the measurements' stamps may be off, as a standard deviation");
  keys.Number("servo.mount_shift_sigma", c.mount_shift_sigma, 0.0, 1.0, "m",
              "how far camera.mount_xyz may be off, as a standard deviation");
  keys.Number("servo.mount_turn_sigma", c.mount_turn_sigma, 0.0, 1.0, "rad",
              "how far the mount's orientation may be off, as a standard deviation");
  keys.Number("servo.scale_sigma", c.scale_sigma, 0.0, 1.0, "",
              "how far focal length and target size may be off, as a share; a standard deviation");
}

void AddLawKeys(ServoSettings& settings, KeyTable& keys) {
  config::LawConfig& c = settings.config.law;
  keys.Flag("servo.auto_track", settings.config.auto_track, "go to Track as soon as the target is known");
  keys.Number("servo.lambda", c.lambda, 0.0, 20.0, "1/s", "gain: the error decays like exp(-lambda t)");
  keys.Number("servo.lambda_near", c.lambda_near, 0.0, 20.0, "1/s",
              "gain near the goal, servo.lambda being that of large errors; 0: servo.lambda everywhere");
  keys.Number("servo.lambda_slope", c.lambda_slope, 0.0, 1e6, "1/s",
              "how fast the gain changes with the feature's error at the goal, per unit of it");
  std::vector<std::string> forms{"auto"};
  forms.insert(forms.end(), features::kFormNames.begin(), features::kFormNames.end());
  keys.Choice(
      "servo.feature", settings.feature, forms,
      "what the law works on; auto: sphere P/R, circle x, y, D/Z, the square's corners, the triangle's pose; "
      "circle also for a sphere, side and corner_side for a square (4 of 6 degrees of freedom), pose and "
      "corners for both");
  keys.Flag("servo.hold_orientation", settings.config.feature.hold_orientation,
            "also keep the camera's orientation as it was when tracking began; sphere, circle, side");
  keys.Choice("servo.interaction", settings.interaction,
              {config::kInteractionNames.begin(), config::kInteractionNames.end()},
              "the interaction matrix that the law inverts: of now, of the goal, or the mean of both");
  keys.Numbers("servo.goal", settings.goal, 3, 3, -10.0, 10.0, "m",
               "where the target's centre shall stand in camera axes: x right, y down, z forward");
  keys.Numbers(
      "servo.goal_rpy_deg", settings.goal_rpy_deg, 3, 3, -360.0, 360.0, "deg",
      "and how a square or triangle shall be turned there: roll, pitch, yaw about fixed camera axes; 0: it "
      "faces the camera");
  keys.Number("servo.smooth_start_s", c.smooth_start_s, 0.001, 10.0, "s",
              "the law is blended in over this time");
  keys.Number("servo.damping", c.damping, 1e-6, 1.0, "",
              "the task is damped in directions whose singular value is below this share of the rms one");
  keys.Number("servo.posture_gain", c.posture_gain, 0.0, 20.0, "1/s",
              "pull of the posture in the directions that the feature leaves free");
  keys.Number("servo.joint_limit_gain", c.joint_limit_gain, 0.0, 20.0, "1/s",
              "and away from the ends of the joints' ranges");
  keys.Number("servo.manipulability_gain", c.manipulability_gain, 0.0, 20.0, "rad^2/s",
              "and towards more manipulability");
  keys.Number("servo.free_speed", c.free_speed, 1e-6, 10.0, "rad/s", "all these together no faster");
  keys.Numbers("servo.posture", settings.posture, 1, model::kMaxJoints, -1e4, 1e4, "rad",
               "that posture, one per joint; the arm's ready posture when not given");
  keys.Number("servo.unreachable_s", c.unreachable_s, 0.001, 60.0, "s",
              "limits keep the arm from the goal for so long: Hold");
  keys.Number("servo.unreachable_progress", c.unreachable_progress, 0.0, 1.0, "",
              "kept from it means that less than this share of the wanted motion is left");
}

void AddMotionLawKeys(ServoSettings& settings, KeyTable& keys) {
  config::MotionLawConfig& c = settings.config.motion_law;
  std::vector<std::string> laws;
  laws.reserve(motion_laws::kMotionLaws.size());
  for (const motion_laws::MotionLawEntry& law : motion_laws::kMotionLaws) {
    laws.emplace_back(law.name);
  }
  keys.Choice("servo.motion_law", settings.motion_law, laws,
              "how the joints follow their reference; float: not at all, to be led by hand");
  keys.Number("servo.omega_n", c.omega_n, 0.1, 300.0, "rad/s", "natural frequency of the joints' error");
  keys.Number("servo.zeta", c.zeta, 0.1, 10.0, "", "damping of the joints' error");
  keys.Number("servo.integral", c.integral, 0.0, 100.0, "1/s",
              "computed_torque: how fast an error that stays is made up for; 0: not");
  keys.Number("servo.integral_torque_fraction", c.integral_torque_fraction, 0.0, 1.0, "",
              "with at most this share of a joint's torque");
  keys.Numbers("servo.k_p", settings.k_p, 1, model::kMaxJoints, 0.0, 1e6, "Nm/rad",
               "pd and joint_impedance: stiffness, one per joint; from servo.omega_n when not given");
  keys.Numbers("servo.k_v", settings.k_v, 1, model::kMaxJoints, 0.0, 1e6, "Nm s/rad",
               "and damping, one per joint; from servo.zeta when not given");
  keys.Number("servo.friction_compensation", c.friction_compensation, 0.0, 1.0, "",
              "share of the joints' friction that the servo makes up for, where the robot does not");
  keys.Number("servo.friction_width", c.friction_width, 1e-9, 10.0, "rad/s",
              "the sign of a speed is smooth within this");
  keys.Number("servo.friction_slow", c.friction_slow, 1e-9, 10.0, "rad/s",
              "below it the sign of the wanted speed has the say");
  keys.Number("servo.operational_damping", c.operational_damping, 1e-9, 1.0, "",
              "operational_space: damping near a singularity, relative to the inertia's size");
  keys.Number("servo.change_s", c.change_s, 0.001, 10.0, "s", "one law takes over from another in this time");
}

void AddMoveKeys(config::MoveConfig& c, KeyTable& keys) {
  const std::string of_hand = "of the end effector in commanded motions";
  keys.Number("servo.move_speed", c.speed, 0.001, 10.0, "m/s", of_hand);
  keys.Number("servo.move_acceleration", c.acceleration, 0.001, 1000.0, "m/s^2", of_hand);
  keys.Number("servo.move_jerk", c.jerk, 0.001, 1e6, "m/s^3", of_hand);
  keys.Number("servo.turn_speed", c.turn_speed, 0.001, 10.0, "rad/s", of_hand);
  keys.Number("servo.turn_acceleration", c.turn_acceleration, 0.001, 1000.0, "rad/s^2", of_hand);
  keys.Number("servo.turn_jerk", c.turn_jerk, 0.001, 1e6, "rad/s^3", of_hand);
  keys.Number("servo.pose_gain", c.pose_gain, 0.0, 200.0, "1/s",
              "takes away what the end effector is off its commanded way");
  keys.Number("servo.pose_error_max", c.pose_error_max, 1e-6, 10.0, "m",
              "further off, and the motion is refused");
}

void AddGuardKeys(ServoSettings& settings, KeyTable& keys) {
  config::GuardConfig& c = settings.config.guard;
  const std::string share = "share of the arm's own limit that the reference may use";
  keys.Number("safety.joint_velocity_fraction", c.joint_velocity_fraction, 0.001, 1.0, "", share);
  keys.Number("safety.joint_acceleration_fraction", c.joint_acceleration_fraction, 0.001, 1.0, "", share);
  keys.Number("safety.joint_jerk_fraction", c.joint_jerk_fraction, 0.001, 1.0, "", share);
  keys.Number("safety.joint_position_margin", c.joint_position_margin, 0.0, 1.0, "rad",
              "the reference stays so far inside each joint's range");
  keys.Number("safety.braking_fraction", c.braking_fraction, 0.001, 0.9, "",
              "share of the acceleration limit that stops a joint before the end of its range");
  keys.Number("safety.workspace_radius", c.workspace_radius, 0.01, 1000.0, "m",
              "the end effector stays in this sphere about the base");
  keys.Number("safety.workspace_margin", c.workspace_margin, 0.0, 1.0, "m", "and so far inside it");
  keys.Number("safety.workspace_deceleration", c.workspace_deceleration, 0.01, 100.0, "m/s^2",
              "with which it stops before it");
  keys.Number("safety.cartesian_speed", c.cartesian_speed, 0.001, 100.0, "m/s", "of the end effector");
  keys.Number(
      "safety.singularity_min", c.singularity_min, 0.0, 1.0, "",
      "the hand goes no nearer to a singular posture, but for a motion of the joints that ends clear of it: "
      "smallest singular value of its Jacobian, a metre counted as 1 / 0.3 rad; 0: it may");
  keys.Flag("safety.keep_in_view", settings.keep_in_view, "keep the target in the picture");
  keys.Number("safety.view_margin_px", settings.view_margin_px, 0.0, 1000.0, "px",
              "and its outline so far from the edge");
  keys.Number(
      "safety.sight_clearance", c.sight_clearance, 0.0, 10.0, "m",
      "the lines of the arm's own links stay so far from the lines of sight to it, or come no nearer; 0: "
      "they may");
  keys.Number(
      "safety.hand_clearance", c.hand_clearance, 0.0, 10.0, "m",
      "the hand's line stays so far from those of the arm's first links, or comes no nearer; 0: it may");
  keys.Number(
      "safety.face_tilt_max", settings.face_tilt_max, 0.1, std::numbers::pi / 2.0, "rad",
      "a disc's face is turned away from the line of sight by no more than this, or no further; pi / 2: "
      "it may be seen edge-on");
  keys.Number("safety.camera_radius", settings.camera_radius, 0.0, 1.0, "m",
              "the camera is guarded as a capsule of this radius from the flange to its lens; 0: as nothing");
  keys.Numbers(
      "safety.tools", settings.tools, 0, 7 * kMostTools, -10.0, 10.0, "m",
      "tools on the hand, guarded as capsules: x, y, z of one end, of the other, in axes of the flange, "
      "radius, the same again");
  keys.Number("safety.link_radius", c.link_radius, 0.0, 1.0, "m",
              "the arm's links from the elbow on are so thick before a plane");
  keys.Numbers(
      "safety.planes", settings.planes, 0, 4 * config::Obstacles::kMost, -100.0, 100.0, "m",
      "planes n p >= d that hand, camera, tools and the arm's links from the elbow on stay above: n_x, n_y, "
      "n_z, d, the same again");
  keys.Numbers("safety.boxes", settings.boxes, 0, 6 * config::Obstacles::kMost, -100.0, 100.0, "m",
               "boxes that hand, camera and tools stay out of: low x, y, z, high x, y, z, the same again");
}

void AddFaultKeys(config::SafetyConfig& c, KeyTable& keys) {
  keys.Number("safety.torque_fraction", c.torque_fraction, 0.001, 1.0, "",
              "share of the arm's torque range in use");
  keys.Number("safety.torque_rate_fraction", c.torque_rate_fraction, 0.001, 1.0, "",
              "share of the arm's torque rate in use");
  keys.Integer("safety.arm_lost_ticks", c.arm_lost_ticks, 1, 10000, "ms",
               "without a new state for so long: Fault");
  keys.Integer("safety.non_finite_ticks", c.non_finite_ticks, 0, 10000, "ms",
               "a joint value that is no number is bridged for so long, then: Fault");
  keys.Integer("safety.missed_ticks", c.missed_ticks, 1, 10000, "ms",
               "so many deadlines missed in a row: Fault");
  keys.Integer("safety.boot_ticks", c.boot_ticks, 1, 10000, "ms",
               "the arm must have been sound for so long before it is moved");
  keys.Number("safety.boot_velocity", c.boot_velocity, 1e-6, 1e3, "rad/s",
              "and every joint slower than this");
  keys.Number("safety.stiction_fraction", c.stiction_fraction, 0.0, 10.0, "",
              "share of a joint's Coulomb friction that may hold it still although torque changes");
  keys.Number(
      "safety.encoder_quantum", c.encoder_quantum, 0.0, 0.1, "rad",
      "steps of a joint's reading; one that stays the same while torque should have moved the joint by "
      "three of them: Fault");
  keys.Integer(
      "safety.frozen_ticks", c.frozen_ticks, 0, 10000, "ms",
      "a joint whose velocity has been seen to flicker repeats its reading to the last bit for so long: "
      "Fault; 0: it may");
  keys.Number("safety.setpoint_jump", c.setpoint_jump, 0.0, 1e3, "rad",
              "commanded setpoints start this close to where the arm stands, and go on so");
  keys.Number("safety.following_error", c.following_error, 1e-4, 10.0, "rad",
              "a joint further off its reference: Fault");
  keys.Number("safety.motion_error", c.motion_error, 1e-5, 10.0, "rad",
              "a joint further off a commanded motion, as a mean over a quarter of a second: Hold");
  keys.Number("safety.contact_torque_fraction", c.contact_torque_fraction, 0.001, 1e6, "",
              "pushed from outside with more than this share of a joint's torque: Fault");
  keys.Number("safety.contact_gain", c.contact_gain, 0.1, 300.0, "1/s",
              "of the observer that sees a push from the arm's momentum");
  keys.Number(
      "safety.carried_torque_fraction", c.carried_torque_fraction, 0.0, 1.0, "",
      "an arm that stands carries three quarters of a load that nobody told it of, with at most this share "
      "of a joint's torque; not by the laws that are springs (pd, joint_impedance), nor beside "
      "`servo.integral`; 0: nothing");
  keys.Number("safety.fault_damping", c.fault_damping, 0.1, 100.0, "1/s", "of the stop after a fault");
  keys.Number("safety.brake_velocity", c.brake_velocity, 1e-6, 10.0, "rad/s",
              "after a fault the brakes close when every joint is slower");
  keys.Number("safety.brake_after_s", c.brake_after_s, 0.0, 60.0, "s", "or after this time");
}

void SetFeature(const ServoSettings& settings, const TargetSettings& target,
                features::TargetFeature& feature) {
  const bool hold_orientation = feature.hold_orientation;
  feature = MakeTarget(target);
  feature.hold_orientation = hold_orientation;
  feature.p_CO_C_star = model::Vec3(settings.goal[0], settings.goal[1], settings.goal[2]);
  feature.R_CO_star = RollPitchYaw(settings.goal_rpy_deg);
  if (settings.feature != "auto") {
    const auto* form = std::find(features::kFormNames.begin(), features::kFormNames.end(), settings.feature);
    feature.form = static_cast<features::FeatureForm>(form - features::kFormNames.begin());
  }
  if (!feature.IsListed()) {
    throw InputError(fmt::format(
        "servo.feature = \"{}\"{} is not allowed for target.kind = \"{}\": sphere has sphere and circle, "
        "circle has circle, square has corners, side, corner_side and pose, triangle has pose and corners; "
        "with "
        "servo.hold_orientation no more than {} entries in all",
        settings.feature, hold_orientation ? " with servo.hold_orientation" : "", target.kind,
        features::kMaxDim));
  }
}

config::ViewConfig MakeView(const ServoSettings& settings, const vision::Intrinsics& in) {
  const double margin = settings.view_margin_px;
  const auto side = [margin](double edge_px, double sign, double c_px, double f_px) {
    return (edge_px - sign * margin - c_px) / f_px;
  };
  config::ViewConfig view;
  view.enabled = settings.keep_in_view;
  view.face_cosine_min =
      settings.face_tilt_max < 0.5 * std::numbers::pi ? std::cos(settings.face_tilt_max) : 0.0;
  view.x_min = side(-0.5, -1.0, in.c_u_px, in.f_u_px);
  view.x_max = side(in.width_px - 0.5, 1.0, in.c_u_px, in.f_u_px);
  view.y_min = side(-0.5, -1.0, in.c_v_px, in.f_v_px);
  view.y_max = side(in.height_px - 0.5, 1.0, in.c_v_px, in.f_v_px);
  if (view.enabled && !(view.x_min < view.x_max && view.y_min < view.y_max)) {
    throw InputError(
        fmt::format("safety.view_margin_px = {} is not allowed: of a picture of {} x {} px nothing is left",
                    margin, in.width_px, in.height_px));
  }
  return view;
}

// Values that are allowed each by itself and must fit each other.
void CheckTogether(const config::ServoConfig& c) {
  const model::Vec3& goal = c.feature.p_CO_C_star;
  if (!c.feature.SeesOrientation() && goal.z() <= c.feature.radius) {
    throw InputError(fmt::format(
        "servo.goal = [{}, {}, {}] is not allowed: the target must be wholly before the camera, so "
        "the third above its radius of {} m",
        goal.x(), goal.y(), goal.z(), c.feature.radius));
  }
  if (c.predict.stale_s > c.predict.coast_s) {
    throw InputError(fmt::format("servo.stale_s = {} is not allowed: at most servo.coast_s, which is {} s",
                                 c.predict.stale_s, c.predict.coast_s));
  }
  if (c.guard.workspace_margin >= c.guard.workspace_radius) {
    throw InputError(fmt::format(
        "safety.workspace_margin = {} is not allowed: below safety.workspace_radius, which is {} m",
        c.guard.workspace_margin, c.guard.workspace_radius));
  }
}

void CheckSize(const char* key, const std::vector<double>& values, const robots::Robot& robot) {
  if (!values.empty() && static_cast<int>(values.size()) != robot.model.num_joints) {
    throw InputError(fmt::format("{} has {} entries, arm \"{}\" has {} joints", key, values.size(),
                                 robot.name, robot.model.num_joints));
  }
}

void SetObstacles(const ServoSettings& settings, config::Obstacles& obstacles) {
  const std::vector<double>& planes = settings.planes;
  const std::vector<double>& boxes = settings.boxes;
  if (planes.size() % 4 != 0) {
    throw InputError(
        fmt::format("safety.planes has {} entries: four for each plane are allowed", planes.size()));
  }
  if (boxes.size() % 6 != 0) {
    throw InputError(fmt::format("safety.boxes has {} entries: six for each box are allowed", boxes.size()));
  }
  for (std::size_t i = 0; i < planes.size(); i += 4) {
    const model::Vec3 normal(planes[i], planes[i + 1], planes[i + 2]);
    const double length = normal.norm();
    if (!(length > 1e-6)) {
      throw InputError("safety.planes: a plane's normal must not be zero");
    }
    obstacles.planes[static_cast<std::size_t>(obstacles.num_planes++)] = {normal / length,
                                                                          planes[i + 3] / length};
  }
  for (std::size_t i = 0; i < boxes.size(); i += 6) {
    config::Box& box = obstacles.boxes[static_cast<std::size_t>(obstacles.num_boxes++)];
    box.low = {boxes[i], boxes[i + 1], boxes[i + 2]};
    box.high = {boxes[i + 3], boxes[i + 4], boxes[i + 5]};
    if (!(box.low.array() < box.high.array()).all()) {
      throw InputError("safety.boxes: each low corner must be below its high corner");
    }
  }
}

void SetPredict(const ServoSettings& settings, const vision::Intrinsics& in, config::PredictConfig& c) {
  const std::vector<double>& region = settings.target_region;
  c.target_region = {{region[0], region[1], region[2]}, {region[3], region[4], region[5]}};
  if (!(c.target_region.low.array() < c.target_region.high.array()).all()) {
    throw InputError("servo.target_region: the low corner must be below the high corner");
  }
  if (in.f_u_px > 0.0) {  // a log without a camera has none
    c.stuck_shift = settings.stuck_shift_px / in.f_u_px;
  }
}

void SetHand(const ServoSettings& settings, const model::Pose& X_EC, config::HandShape& hand) {
  bool fits = true;
  if (settings.camera_radius > 0.0) {
    fits = hand.AddCapsule(model::Vec3::Zero(), X_EC.p, settings.camera_radius);
  }
  const std::vector<double>& t = settings.tools;
  if (t.size() % 7 != 0) {
    throw InputError(fmt::format("safety.tools has {} entries: seven for each tool are allowed", t.size()));
  }
  for (std::size_t i = 0; i < t.size(); i += 7) {
    if (!(t[i + 6] > 0.0)) {
      throw InputError("safety.tools: each radius must be above 0");
    }
    fits = fits && hand.AddCapsule({t[i], t[i + 1], t[i + 2]}, {t[i + 3], t[i + 4], t[i + 5]}, t[i + 6]);
  }
  if (!fits) {
    throw InputError(
        fmt::format("safety.tools and safety.camera_radius are not allowed: {} balls, each a radius from the "
                    "next, must cover camera and tools; take larger radii",
                    config::HandShape::kMost));
  }
}

void SetMotionLaw(const ServoSettings& settings, const robots::Robot& robot, config::MotionLawConfig& c) {
  for (const motion_laws::MotionLawEntry& law : motion_laws::kMotionLaws) {
    if (settings.motion_law == law.name) {
      c.kind = law.kind;
      if (robot.model.num_joints < law.joints_min) {
        throw InputError(
            fmt::format("servo.motion_law = \"{}\" is not allowed: it takes {} joints, arm \"{}\" has {}",
                        law.name, law.joints_min, robot.name, robot.model.num_joints));
      }
    }
  }
  CheckSize("servo.k_p", settings.k_p, robot);
  CheckSize("servo.k_v", settings.k_v, robot);
  model::ArmPoses poses;
  model::ArmDynamics dynamics;
  const model::VecN q = model::ToVector(robot.model.q_ready, robot.model.num_joints);
  model::ComputePoses(robot.model, q, poses);
  model::ComputeDynamics(robot.model, poses, model::VecN::Zero(q.size()), dynamics);
  c.damp_by_inertia = settings.k_v.empty();
  for (int i = 0; i < robot.model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double inertia = dynamics.M(i, i);
    c.k_p[k] = settings.k_p.empty() ? inertia * c.omega_n * c.omega_n : settings.k_p[k];
    c.k_v[k] = settings.k_v.empty() ? 2.0 * c.zeta * std::sqrt(c.k_p[k] * inertia) : settings.k_v[k];
  }
}

}  // namespace

void AddServoKeys(ServoSettings& settings, KeyTable& keys) {
  AddLawKeys(settings, keys);
  AddMotionLawKeys(settings, keys);
  AddPredictKeys(settings, keys);
  AddMoveKeys(settings.config.move, keys);
  AddGuardKeys(settings, keys);
  AddFaultKeys(settings.config.safety, keys);
}

void ScaleSpeed(double scale, ServoSettings& settings) {
  settings.config.law.lambda *= scale;
  settings.config.law.lambda_near *= scale;
  settings.config.guard.joint_velocity_fraction *= scale;
  settings.config.guard.cartesian_speed *= scale;
}

config::ServoConfig MakeServoConfig(const ServoSettings& settings, const robots::Robot& robot,
                                    const model::Pose& X_EC, const vision::Intrinsics& intrinsics,
                                    const TargetSettings& target) {
  config::ServoConfig config = settings.config;
  config.arm = robot.model;
  config.X_EC = X_EC;
  SetFeature(settings, target, config.feature);
  config.guard.view = MakeView(settings, intrinsics);
  const auto* interaction =
      std::find(config::kInteractionNames.begin(), config::kInteractionNames.end(), settings.interaction);
  config.law.interaction = static_cast<config::Interaction>(interaction - config::kInteractionNames.begin());
  config.law.q_posture = robot.model.q_ready;
  CheckSize("servo.posture", settings.posture, robot);
  if (!settings.posture.empty()) {
    for (std::size_t i = 0; i < settings.posture.size(); ++i) {
      config.law.q_posture[i] = settings.posture[i];
    }
  }
  SetMotionLaw(settings, robot, config.motion_law);
  SetObstacles(settings, config.guard.obstacles);
  SetHand(settings, X_EC, config.guard.hand);
  SetPredict(settings, intrinsics, config.predict);
  CheckTogether(config);
  task::ServoTask probe;
  if (const hal::Status status = probe.Init(config); !status.ok()) {
    throw InputError(fmt::format("{}: {}", status.where(), hal::ToString(status.code())));
  }
  return config;
}

}  // namespace fovea::config
