// SPDX-License-Identifier: Apache-2.0
// Makes the servo's configuration from the keys' settings, an arm, a camera mount and a target.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/core/control/visual_laws.hpp"
#include "firmware/core/guard/motor_need.hpp"
#include "firmware/core/model/ready_inertia.hpp"
#include "firmware/core/motion_laws/motion_laws.hpp"
#include "firmware/core/task/servo_task.hpp"
#include "firmware/core/trajectory/plan_request.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/roll_pitch_yaw.hpp"
#include "firmware/host/config/servo_keys.hpp"

namespace fovea::config {
namespace {

// `name` is one of kLawNames.
Law LawNamed(const std::string& name) {
  const auto* found = std::find(kLawNames.begin(), kLawNames.end(), name);
  return static_cast<Law>(found - kLawNames.begin());
}

// "sphere has sphere and circle, circle has circle, ..."
std::string FormsInWords() {
  std::string words;
  for (const features::TargetTraits& target : features::kTargets) {
    std::vector<std::string> forms;
    for (const features::FeatureForm form : target.forms) {
      const std::string name = features::kFormNames[static_cast<std::size_t>(form)];
      if (std::find(forms.begin(), forms.end(), name) == forms.end()) {
        forms.push_back(name);
      }
    }
    const std::string last = forms.back();
    forms.pop_back();
    words += fmt::format("{}{} has {}{}{}", words.empty() ? "" : ", ", target.name, fmt::join(forms, ", "),
                         forms.empty() ? "" : " and ", last);
  }
  return words;
}

// The feature of servo.law, if that is named, or else the target's own.
features::FeatureForm DefaultForm(const ServoSettings& settings, const features::TargetTraits& traits) {
  if (settings.law == "auto") {
    return traits.form;
  }
  return TraitsOf(LawNamed(settings.law)).form.value_or(traits.ImageForm());
}

// Law and feature must fit together.
void SetLaw(const ServoSettings& settings, features::FeatureForm form, LawConfig& config) {
  if (settings.law == "auto") {
    config.law = LawOf(form);
    return;
  }
  config.law = LawNamed(settings.law);
  const std::optional<features::FeatureForm> own = TraitsOf(config.law).form;
  if (own ? form != *own : !features::IsInImage(form)) {
    throw InputError(fmt::format(
        "servo.law = \"{}\" is not allowed with servo.feature = \"{}\": allowed are \"auto\" and {}",
        settings.law, settings.feature,
        own ? fmt::format("\"{}\"", features::kFormNames[static_cast<std::size_t>(*own)])
            : "a feature in the image"));
  }
}

void SetFeature(const ServoSettings& settings, const TargetSettings& target,
                features::TargetFeature& feature) {
  const bool hold_orientation = feature.hold_orientation;
  feature = MakeTarget(target);
  feature.hold_orientation = hold_orientation;
  feature.p_CO_C_star = model::Vec3(settings.goal[0], settings.goal[1], settings.goal[2]);
  feature.R_CO_star = RollPitchYaw(settings.goal_rpy_deg);
  feature.form = DefaultForm(settings, features::TraitsOf(feature.target));
  if (settings.feature != "auto") {
    const auto* form = std::find(features::kFormNames.begin(), features::kFormNames.end(), settings.feature);
    feature.form = static_cast<features::FeatureForm>(form - features::kFormNames.begin());
  }
  if (!feature.IsListed()) {
    throw InputError(
        fmt::format("servo.feature = \"{}\"{} is not allowed for target.kind = \"{}\": {}; with "
                    "servo.hold_orientation no "
                    "more than {} entries in all",
                    settings.feature, hold_orientation ? " with servo.hold_orientation" : "", target.kind,
                    FormsInWords(), features::kMaxDim));
  }
}

ViewConfig MakeView(const ServoSettings& settings, const vision::Intrinsics& in) {
  if (!(in.f_u_px > 0.0)) {
    return {};  // a log without a camera
  }
  const double margin = settings.view_margin_px;
  const auto side = [margin](double edge_px, double sign, double c_px, double f_px) {
    return (edge_px - sign * margin - c_px) / f_px;
  };
  ViewConfig view;
  view.enabled = settings.keep_in_view;
  view.disc_cosine_min =
      settings.disc_tilt_max < 0.5 * std::numbers::pi ? std::cos(settings.disc_tilt_max) : 0.0;
  view.x_min = side(-0.5, -1.0, in.c_u_px, in.f_u_px);
  view.x_max = side(in.width_px - 0.5, 1.0, in.c_u_px, in.f_u_px);
  view.y_min = side(-0.5, -1.0, in.c_v_px, in.f_v_px);
  view.y_max = side(in.height_px - 0.5, 1.0, in.c_v_px, in.f_v_px);
  if (view.enabled && !(view.x_min < view.x_max && view.y_min < view.y_max)) {
    throw InputError(
        fmt::format("safety.view_margin_px = {} is not allowed: it leaves nothing of a picture of {} x {} px",
                    margin, in.width_px, in.height_px));
  }
  return view;
}

// Checks values that are each allowed alone but must fit together.
void CheckTogether(const ServoConfig& c) {
  const model::Vec3& goal = c.feature.p_CO_C_star;
  if (!c.feature.SeesOrientation() && goal.z() <= c.feature.radius) {
    throw InputError(fmt::format(
        "servo.goal = [{}, {}, {}] is not allowed: the target must be wholly in front of the camera, so "
        "the third number must be above its radius of {} m",
        goal.x(), goal.y(), goal.z(), c.feature.radius));
  }
  if (c.predict.stale_s > c.predict.coast_s) {
    throw InputError(fmt::format("servo.stale_s = {} is not allowed: at most servo.coast_s, which is {} s",
                                 c.predict.stale_s, c.predict.coast_s));
  }
  if (!IsPossible(c.load)) {
    throw InputError(
        fmt::format("servo.load_offset = {:g} is not allowed: at least -arm.load_mass, which is {:g} kg",
                    c.load.offset, c.load.mass));
  }
  if (const double most = c.motion_law.zeta * c.motion_law.omega_n; c.motion_law.integral > most) {
    throw InputError(fmt::format(
        "servo.integral = {} is not allowed: at most servo.zeta times servo.omega_n, which is {:g} "
        "1/s; at twice that value the joints' error grows",
        c.motion_law.integral, most));
  }
  if (const guard::MotorNeed need = guard::LargestMotorNeed(c); !(need.torque <= need.allowed)) {
    throw InputError(fmt::format(
        "arm.load_mass, safety.joint_acceleration_fraction and safety.torque_fraction do not fit: with the "
        "load, joint {} needs {:.3g} for its allowed acceleration, its motor may give only {:.3g} (Nm, N)",
        need.joint + 1, need.torque, need.allowed));
  }
  int joint = 0;
  if (const double coupling = model::InertiaAtReady(c.arm).coupling.maxCoeff(&joint);
      !(coupling <= model::kCouplingMost)) {
    throw InputError(fmt::format(
        "arm.load_mass at arm.load_com is not allowed: it couples joint {} to the others and makes it {:.0f} "
        "times as heavy while they are held; at most {:g} times is allowed",
        joint + 1, coupling, model::kCouplingMost));
  }
  if (control::LineOf(c.law.law).predicts && !trajectory::HasGoalPosture(c)) {
    throw InputError(
        "servo.law = \"predictive\" is not allowed: it takes an arm with six or more joints, and a feature "
        "that "
        "determines the camera's whole pose (not side or corner_side, without servo.hold_orientation)");
  }
  if (c.guard.workspace_margin >= c.guard.workspace_radius) {
    throw InputError(fmt::format(
        "safety.workspace_margin = {} is not allowed: must be below safety.workspace_radius, which is {} m",
        c.guard.workspace_margin, c.guard.workspace_radius));
  }
}

void CheckSize(const char* key, const std::vector<double>& values, const NamedArm& arm) {
  if (!values.empty() && static_cast<int>(values.size()) != arm.model.num_joints) {
    throw InputError(fmt::format("{} has {} entries, arm \"{}\" has {} joints", key, values.size(), arm.name,
                                 arm.model.num_joints));
  }
}

void SetObstacles(const ServoSettings& settings, Obstacles& obstacles) {
  const std::vector<double>& planes = settings.planes;
  if (planes.size() % 4 != 0) {
    throw InputError(
        fmt::format("safety.planes has {} entries: four for each plane are allowed", planes.size()));
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
  for (const Box& box : MakeBoxes("safety.boxes", settings.boxes)) {
    obstacles.boxes[static_cast<std::size_t>(obstacles.num_boxes++)] = box;
  }
}

void SetPredict(const ServoSettings& settings, const vision::Intrinsics& in, PredictConfig& c) {
  const std::vector<double>& region = settings.target_region;
  c.target_region = {{region[0], region[1], region[2]}, {region[3], region[4], region[5]}};
  if (!(c.target_region.low.array() < c.target_region.high.array()).all()) {
    throw InputError("servo.target_region: the low corner must be below the high corner");
  }
  if (in.f_u_px > 0.0) {  // a log without a camera has none
    c.stuck_shift = settings.stuck_shift_px / in.f_u_px;
    c.row_time = in.row_time * in.f_v_px;
    c.row_y = in.row_time > 0.0 ? (0.5 * (in.height_px - 1) - in.c_v_px) / in.f_v_px : 0.0;
  }
}

void SetHand(const ServoSettings& settings, const model::Pose& X_EC, HandShape& hand) {
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
                    HandShape::kMost));
  }
}

void SetMotionLaw(const ServoSettings& settings, const NamedArm& arm, MotionLawConfig& c) {
  CheckSize("servo.k_p", settings.k_p, arm);
  CheckSize("servo.k_v", settings.k_v, arm);
  const model::VecN M_ii = model::InertiaAtReady(arm.model).held;
  c.damp_by_inertia = settings.k_v.empty();
  for (int i = 0; i < arm.model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double inertia = M_ii[i];
    c.k_p[k] = settings.k_p.empty() ? inertia * c.omega_n * c.omega_n : settings.k_p[k];
    c.k_v[k] = settings.k_v.empty() ? 2.0 * c.zeta * std::sqrt(c.k_p[k] * inertia) : settings.k_v[k];
  }
  const motion_laws::MotionLawEntry& law = motion_laws::EntryOf(c.kind);
  const char* name = kMotionLawNames[static_cast<std::size_t>(c.kind)];
  const motion_laws::Fitness fitness = motion_laws::FitnessOf(c, arm.model, c.kind);
  switch (fitness.why) {
    case motion_laws::Unfit::kNone: break;
    case motion_laws::Unfit::kTooFewJoints:
      throw InputError(
          fmt::format("servo.motion_law = \"{}\" is not allowed: it takes {} joints, arm \"{}\" has {}", name,
                      law.joints_min, arm.name, arm.model.num_joints));
    case motion_laws::Unfit::kDampedTooFast:
      throw InputError(
          fmt::format("{} is not allowed: joint {} is damped at {:.0f} 1/s, which is {}; motion law "
                      "\"{}\" allows at most {:g} 1/s",
                      law.has_springs ? "servo.k_v (or servo.zeta, servo.omega_n, servo.k_p, which make it)"
                                      : "servo.zeta with servo.omega_n",
                      fitness.joint + 1, fitness.damping,
                      law.has_springs ? "k_v over its inertia" : "2 zeta omega_n", name, law.damping_most));
  }
}

}  // namespace

std::vector<Box> MakeBoxes(const std::string& key, const std::vector<double>& corners) {
  if (corners.size() % 6 != 0) {
    throw InputError(fmt::format("{} has {} entries: six for each box are allowed", key, corners.size()));
  }
  std::vector<Box> boxes;
  for (auto box = corners.begin(); box != corners.end(); box += 6) {
    boxes.push_back({{box[0], box[1], box[2]}, {box[3], box[4], box[5]}});
    if (!(boxes.back().low.array() < boxes.back().high.array()).all()) {
      throw InputError(
          fmt::format("{}: box {}: each low corner must be below its high corner", key, boxes.size()));
    }
  }
  return boxes;
}

ServoConfig MakeServoConfig(const ServoSettings& settings, const NamedArm& arm, const model::Pose& X_EC,
                            const vision::Intrinsics& intrinsics, const TargetSettings& target) {
  static_cast<void>(LearntOf(settings));  // refuses an unknown word
  ServoConfig config = settings.config;
  config.arm = arm.model;
  config.X_EC = X_EC;
  config.load.mass = arm.load.mass;
  config.load.p_ECom = arm.load.p_ECom;
  SetFeature(settings, target, config.feature);
  SetLaw(settings, config.feature.form, config.law);
  config.guard.view = MakeView(settings, intrinsics);
  config.law.q_posture = arm.model.q_ready;
  CheckSize("servo.posture", settings.posture, arm);
  if (!settings.posture.empty()) {
    for (std::size_t i = 0; i < settings.posture.size(); ++i) {
      config.law.q_posture[i] = settings.posture[i];
    }
  }
  SetMotionLaw(settings, arm, config.motion_law);
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
