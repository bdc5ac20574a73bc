// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/scenario.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/inside_folder.hpp"
#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/robots/shipped_robots.hpp"
#include "sim/scenario/realism.hpp"

namespace fovea::sim {
namespace {

namespace fs = std::filesystem;
using config::InputError;

void AddArmKeys(Scenario& s, config::KeyTable& keys) {
  keys.Text("arm.model", s.arm.model,
            "a shipped arm by name, or the path of an arm file or URDF: in the scenario's folder, or "
            "anywhere with --set");
  keys.Numbers("arm.q_start", s.arm.q_start, 1, model::kMaxJoints, -1e4, 1e4, "rad",
               "joint positions at the start, one per joint");
  keys.Numbers("arm.dq_start", s.arm.dq_start, 1, model::kMaxJoints, -100.0, 100.0, "rad/s",
               "joint velocities at the start, one per joint; at rest when not given");
  keys.Numbers("arm.spring", s.arm.spring, 1, model::kMaxJoints, 0.0, 1e6, "Nm/rad",
               "springs that pull each joint to 0, one per joint, known to the servo; none when not given");
  keys.Numbers("arm.viscous", s.arm.viscous, 1, model::kMaxJoints, 0.0, 1e6, "Nm s/rad",
               "viscous friction, one per joint; the URDF's damping when not given");
  keys.Numbers("arm.coulomb", s.arm.coulomb, 1, model::kMaxJoints, 0.0, 1e6, "Nm",
               "Coulomb friction, one per joint; the URDF's friction when not given");
  keys.Flag("arm.stiction", s.arm.stiction,
            "true: Coulomb friction holds a joint at rest; false: it is smooth around zero speed");
  keys.Number("arm.friction_compensation", s.arm.friction_compensation, 0.0, 1.0, "",
              "share of the joints' friction that the robot's own controller compensates");
  keys.Number("arm.encoder_noise", s.arm.encoder_noise, 0.0, 0.1, "rad",
              "standard deviation of measured positions");
  keys.Number("arm.encoder_quantum", s.arm.encoder_quantum, 0.0, 0.1, "rad",
              "measured positions are rounded to multiples of it, velocities are not; 0: no rounding");
  keys.Number("arm.velocity_noise", s.arm.velocity_noise, 0.0, 1.0, "rad/s",
              "standard deviation of measured velocities");
  keys.Choice("arm.integrator", s.arm.integrator, {"euler", "rk4"},
              "how the physics steps: semi-implicit Euler, or Runge-Kutta of order 4 at 3.5 times the cost");
  config::AddLoadKeys(s.arm.load, keys);
  keys.Choice("arm.realism", s.arm.realism, {"ideal", "panda", "ur"},
              "figures of real arms for rotors, drives and encoders, in place of the defaults of those keys: "
              "a Panda's, a UR5e's; a key that is given wins");
  keys.Numbers("arm.rotor_inertia", s.arm.rotor_inertia, 1, model::kMaxJoints, 0.0, 1e3, "kg m^2",
               "inertias of the motors' rotors, seen at the joints, one per joint, known to the servo; the "
               "arm file's when not given");
  AddDriveKeys(s.arm.drives, keys);
}

void AddSensorKeys(Scenario& s, config::KeyTable& keys) {
  keys.Number("camera.shot_noise", s.camera.shot_noise, 0.0, 100.0, "gray levels",
              "photon noise: variance of a pixel per gray level, at gain 1; the reciprocal is the number of "
              "electrons per gray level");
  keys.Number("camera.gain", s.camera.gain, 0.05, 100.0, "",
              "the sensor's gain: signal and noise times this");
  keys.Number("camera.saturation", s.camera.saturation, 1.0, 255.0, "gray levels",
              "a pixel collects no more light than this, at gain 1");
  keys.Flag("camera.vignetting", s.camera.vignetting,
            "true: a pixel gets cos^4 of the light, of its angle to the optical axis");
  keys.Choice(
      "camera.bayer", s.camera.bayer, {"none", "BayerRG8", "BayerGR8", "BayerGB8", "BayerBG8"},
      "each pixel has one colour, by this pattern; the others are interpolated as the drivers do; none: "
      "each pixel has all colours");
  keys.Number("camera.auto_exposure_level", s.camera.auto_exposure_level, 0.0, 255.0, "gray levels",
              "automatic exposure: a gain that keeps the mean of a picture at this; 0: none");
  keys.Number("camera.auto_exposure_lag_s", s.camera.auto_exposure_lag_s, 0.001, 100.0, "s",
              "time constant of the automatic exposure");
  keys.Number("camera.auto_exposure_gain_max", s.camera.auto_exposure_gain_max, 1.0, 1000.0, "",
              "largest gain of the automatic exposure, and the reciprocal of its smallest");
}

void AddCameraKeys(Scenario& s, config::KeyTable& keys) {
  keys.Flag("camera.enabled", s.camera.enabled, "false: a run without camera, for commanded motions");
  config::AddCalibrationKeys(s.camera.calibration, keys, {64, 4096});
  keys.Number("camera.hfov_deg", s.camera.hfov_deg, 5.0, 150.0, "deg",
              "horizontal field of view, if camera.f_u_px, f_v_px, c_u_px and c_v_px are not given");
  keys.Number("camera.rate_hz", s.camera.rate_hz, 1.0, 240.0, "Hz", "frames per second");
  keys.Number("camera.exposure_ms", s.camera.exposure_ms, 0.01, 100.0, "ms",
              "exposure time; stamps are at its middle");
  keys.Integer("camera.sub_exposures", s.camera.sub_exposures, 1, 64, "",
               "motion blur: a picture is the mean of this many sharp ones, spread over the exposure; 1: no "
               "blur");
  keys.Number("camera.latency_ms", s.camera.latency_ms, 0.0, 500.0, "ms",
              "from mid-exposure until the feature reaches the servo");
  keys.Number("camera.noise_sigma", s.camera.noise_sigma, 0.0, 60.0, "gray levels",
              "standard deviation of read noise, at gain 1");
  AddSensorKeys(s, keys);
  keys.Number("camera.light", s.camera.light, 0.01, 4.0, "",
              "brightness of the picture; 1 is a well-lit bench");
}

void AddRunKeys(Scenario& s, config::KeyTable& keys) {
  keys.Text("run.description", s.run.description, "one line for `fovea-sim list`");
  keys.Number("run.duration_s", s.run.duration_s, 0.1, 1e6, "s", "simulated time");
  keys.Integer("run.seed", s.run.seed, 0, 2147483647, "", "seed of all random numbers");
  keys.Number("run.tracking_bound_px", s.run.tracking_bound_px, 0.01, 1e4, "px",
              "a moving target counts as tracked below this error, rms over the second half");
  keys.Number("run.tracking_bound_mm", s.run.tracking_bound_mm, 0.01, 1e4, "mm",
              "a moving target counts as tracked only if this error is also met, rms over the second half");
  keys.Flag("run.scene_video", s.run.scene_video,
            "also film the bench with the paths of camera and target: scene.mp4");
  keys.Number(
      "run.settled_s", s.run.settled_s, 0.0, 1e6, "s",
      "the run ends early once the goal has been kept for this time; in lockstep, with a still target; "
      "0: never");
}

void AddMotionKeys(Scenario& s, config::KeyTable& keys) {
  constexpr std::size_t kMax = model::kMaxJoints;
  keys.Choice(
      "motion.kind", s.motion.kind, {"none", "joints", "waves", "circle", "home"},
      "commanded motion; joints: from + velocity t + amplitude sin(omega t) for each joint; waves: from + "
      "amplitude sin(multiple omega t), softly begun; circle: of the end effector; home: to the arm's ready "
      "posture");
  keys.Numbers("motion.from", s.motion.from, 1, kMax, -1e4, 1e4, "rad",
               "joint positions, one per joint; arm.q_start when not given");
  keys.Numbers("motion.velocity", s.motion.velocity, 1, kMax, -100.0, 100.0, "rad/s",
               "one per joint; 0 when not given");
  keys.Numbers("motion.amplitude", s.motion.amplitude, 1, kMax, -100.0, 100.0, "rad",
               "one per joint; 0 when not given");
  keys.Numbers("motion.multiple", s.motion.multiple, 1, kMax, 0.0, 100.0, "",
               "waves: frequency of each joint, in multiples of omega; 1 when not given");
  keys.Number("motion.omega", s.motion.omega, 1e-3, 1e3, "rad/s", "angular frequency of the sine");
  keys.Numbers("motion.centre", s.motion.centre, 3, 3, -5.0, 5.0, "m", "centre of the circle, in B");
  keys.Numbers("motion.normal", s.motion.normal, 3, 3, -1.0, 1.0, "", "normal of the circle's plane, in B");
  keys.Numbers("motion.hand_rpy_deg", s.motion.hand_rpy_deg, 3, 3, -360.0, 360.0, "deg",
               "roll, pitch, yaw of the end effector on the circle, about fixed axes of B");
  keys.Number("motion.radius", s.motion.radius, 0.001, 2.0, "m", "radius of the circle");
  keys.Number("motion.rate_hz", s.motion.rate_hz, 0.001, 10.0, "Hz", "turns per second");
  keys.Number("motion.lead_s", s.motion.lead_s, 0.1, 1e3, "s", "time to reach the circle's lowest point");
  keys.Number("motion.bound_mm", s.motion.bound_mm, 0.001, 1e3, "mm",
              "the circle counts as followed if the end effector's error never exceeds this");
  keys.Flag("theory.enabled", s.theory.enabled,
            "judge a one-joint arm against its analytic response instead of a target");
  keys.Numbers("theory.fit_s", s.theory.fit_s, 2, 2, 0.0, 1e6, "s",
               "zeta, omega_n and poles are fitted from the first time to the second");
}

constexpr std::size_t kMostBoxes = 16;  // on the bench

fs::path ShippedFolder() { return config::ShareFolder() / "scenarios"; }

// E.g. "ball" or "theory/open-loop".
std::string ShippedName(const fs::path& file) {
  return fs::relative(file, ShippedFolder()).replace_extension().generic_string();
}

fs::path FindScenario(const std::string& name_or_path) {
  if (fs::path(name_or_path).extension() == ".toml") {
    // The file's name becomes the name of the run's folder.
    if (const fs::path name = fs::path(name_or_path).stem(); name == "." || name == "..") {
      throw InputError(fmt::format("{}: a scenario's file needs a name before .toml", name_or_path));
    }
    return name_or_path;
  }
  const fs::path shipped = ShippedFolder() / (name_or_path + ".toml");
  if (fs::is_regular_file(shipped)) {
    return shipped;
  }
  const std::vector<std::string> names = ShippedScenarios();
  throw InputError(fmt::format("unknown scenario \"{}\"{}; shipped are {} (or give the path of a .toml)",
                               name_or_path, config::DidYouMean(name_or_path, names),
                               fmt::join(names, ", ")));
}

}  // namespace

config::KeyTable ScenarioKeys(Scenario& scenario) {
  config::KeyTable keys;
  AddArmKeys(scenario, keys);
  AddCameraKeys(scenario, keys);
  config::AddVisionKeys(scenario.vision, keys);
  AddTargetSceneKeys(scenario.target, keys);
  keys.Numbers("bench.boxes", scenario.boxes, 0, 6 * kMostBoxes, -100.0, 100.0, "m",
               "boxes that stand on the bench: low x, y, z, high x, y, z of each; the servo knows those of "
               "safety.boxes");
  config::AddServoKeys(scenario.servo, keys);
  AddMotionKeys(scenario, keys);
  AddTruthKeys(scenario.truth, keys);
  AddFaultKeys(scenario.faults, keys);
  AddRunKeys(scenario, keys);
  return keys;
}

std::string KeysAsMarkdown(const config::KeyTable& keys) {
  std::string text =
      "# Keys of a scenario\n\n"
      "Printed by `fovea-sim keys --markdown`. A scenario contains only keys that differ from these "
      "defaults.\n";
  std::string section;
  for (const config::Key& key : keys.keys()) {
    const auto dot = key.name.find('.');
    if (key.name.substr(0, dot) != section) {
      section = key.name.substr(0, dot);
      text +=
          fmt::format("\n## [{}]\n\n{}| key | default | unit | allowed | meaning |\n|---|---|---|---|---|\n",
                      section, section == "truth" ? TruthFormsAsMarkdown() + "\n" : "");
    }
    if (key.meaning.empty()) {
      continue;  // a form of [truth]
    }
    text += fmt::format("| `{}` | `{}` | {} | {}: {} | {} |\n", key.name.substr(dot + 1), key.default_text,
                        key.unit, key.kind, key.allowed, key.meaning);
  }
  text +=
      "\n## Former names\n\nA former name is refused; the message names the present one.\n\n"
      "| former | present |\n|---|---|\n";
  for (const auto& [former, today] : keys.successors()) {
    text += fmt::format("| `{}` | `{}` |\n", former, today);
  }
  return text;
}

std::vector<std::string> ShippedScenarios() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(ShippedFolder(), ignored)) {
    if (entry.path().extension() == ".toml") {
      names.push_back(ShippedName(entry.path()));
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

Scenario LoadScenario(const std::string& name_or_path, const std::vector<std::string>& assignments) {
  const fs::path file = FindScenario(name_or_path);
  Scenario scenario;
  const bool is_path = fs::path(name_or_path).extension() == ".toml";
  scenario.name = is_path ? file.stem().string() : ShippedName(file);
  scenario.folder = file.parent_path();
  const config::KeyTable keys = ScenarioKeys(scenario);
  std::set<std::string> given;
  for (const config::Setting& setting : config::ReadTomlFile(file)) {
    keys.Apply(setting);
    given.insert(setting.key);
  }
  for (const std::string& assignment : assignments) {
    const config::Setting setting = config::ParseAssignment(assignment);
    keys.Apply(setting);
    given.insert(setting.key);
    scenario.arm_is_the_users = scenario.arm_is_the_users || setting.key == "arm.model";
  }
  ApplyRealism(given, scenario);
  if (given.contains("target.colour") && !given.contains("vision.hue_deg")) {
    scenario.vision.config.colour.hue_deg =
        HueOfColour(scenario.target.colour).value_or(scenario.vision.config.colour.hue_deg);
  }
  return scenario;
}

robots::Robot LoadScenarioRobot(const Scenario& scenario) {
  const fs::path model = scenario.arm.model;
  if (robots::IsRobotPath(model)) {
    const fs::path beside = scenario.folder / model;
    if (scenario.arm_is_the_users) {
      return robots::LoadRobot(fs::exists(beside) ? beside : model);
    }
    const fs::path root = fs::absolute(scenario.folder / ".");
    if (!config::IsInside(root, model)) {
      throw InputError(fmt::format(
          "arm.model = \"{}\" is not allowed: it lies outside {}, the scenario's folder (--set arm.model=... "
          "names any arm)",
          scenario.arm.model, root.lexically_normal().string()));
    }
    return robots::LoadRobot(beside, root);
  }
  return robots::LoadRobot(robots::FindRobot(scenario.arm.model, "arm.model"));
}

}  // namespace fovea::sim
