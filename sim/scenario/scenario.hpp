// SPDX-License-Identifier: Apache-2.0
// A scenario: everything that can be set about a simulated run. Its defaults are the scenario `ball`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/config/camera_keys.hpp"
#include "firmware/host/config/key_table.hpp"
#include "firmware/host/config/load_keys.hpp"
#include "firmware/host/config/servo_keys.hpp"
#include "firmware/host/config/vision_keys.hpp"
#include "firmware/host/robots/robot.hpp"
#include "sim/scenario/drive_settings.hpp"
#include "sim/scenario/fault_settings.hpp"
#include "sim/scenario/target_scene.hpp"
#include "sim/truth/truth_settings.hpp"

namespace fovea::sim {

struct Scenario {
  std::string name;
  std::filesystem::path folder;   // of its file; a relative arm.model is searched there first
  bool arm_is_the_users = false;  // arm.model comes from --set and may lie anywhere; otherwise in `folder`

  struct {
    std::string model = "panda";
    std::vector<double> q_start{-0.30, -0.75, 0.0, -2.05, 0.0, 1.55, 0.485398};
    std::vector<double> dq_start;  // empty: at rest
    std::vector<double> spring;    // empty: none
    std::vector<double> viscous;   // empty: the URDF's
    std::vector<double> coulomb;   // empty: the URDF's
    bool stiction = false;
    double friction_compensation = 0.9;
    double encoder_noise = 1e-5;
    double encoder_quantum = 0.0;
    double velocity_noise = 5e-4;
    std::string integrator = "euler";
    config::LoadSettings load;
    std::vector<double> rotor_inertia;  // empty: the arm file's
    std::string realism = "ideal";      // see realism.hpp
    DriveSettings drives;
  } arm;

  struct {
    bool enabled = true;
    double hfov_deg = 60.0;
    double rate_hz = 30.0;
    double exposure_ms = 5.0;
    int sub_exposures = 1;
    double latency_ms = 40.0;
    double noise_sigma = 3.0;
    double shot_noise = 0.0;
    double gain = 1.0;
    double saturation = 255.0;
    bool vignetting = false;
    std::string bayer = "none";
    double auto_exposure_level = 0.0;
    double auto_exposure_lag_s = 0.2;
    double auto_exposure_gain_max = 16.0;
    double light = 1.0;
    // As `fovea calibrate` writes it. How well its views fit has no effect here.
    config::CalibrationSettings calibration{.intrinsics = {640, 480, 0.0, 0.0, 0.0, 0.0},
                                            .mount_xyz = {0.05, 0.0, 0.04},
                                            .mount_rpy_deg = {0.0, 0.0, 90.0}};
  } camera;

  TargetScene target;
  std::vector<double> boxes;  // on the bench: low x, y, z, high x, y, z of each [m]

  config::VisionSettings vision;
  config::ServoSettings servo;

  FaultSettings faults;
  TruthSettings truth;

  // A commanded motion; see commanded_motion.hpp.
  struct {
    std::string kind = "none";
    std::vector<double> from;
    std::vector<double> velocity;
    std::vector<double> amplitude;
    std::vector<double> multiple;
    double omega = 1.0;
    std::vector<double> centre{0.45, 0.0, 0.50};
    std::vector<double> normal{1.0, 0.0, 0.0};
    std::vector<double> hand_rpy_deg{180.0, 0.0, 0.0};
    double radius = 0.15;
    double rate_hz = 0.5;
    double lead_s = 3.0;
    double bound_mm = 1.0;
  } motion;

  struct {
    bool enabled = false;
    std::vector<double> fit_s{0.0, 1e6};
  } theory;

  struct {
    std::string description;
    double duration_s = 8.0;
    int seed = 1;
    double tracking_bound_px = 3.0;
    double tracking_bound_mm = 5.0;
    bool scene_video = false;
    double settled_s = 0.0;
  } run;

  Scenario() {
    servo.config.auto_track = true;
    servo.planes = {0.0, 0.0, 1.0, 0.01};  // the bench's table, plus 1 cm
    servo.target_region[2] = -0.1;         // no target is below the table; 0.1 m covers calibration errors
  }
};

// The keys of all sections, bound to `scenario`, which must outlive the table.
config::KeyTable ScenarioKeys(Scenario& scenario);

// One table per section.
std::string KeysAsMarkdown(const config::KeyTable& keys);

// Names of the shipped scenarios, in alphabetical order.
std::vector<std::string> ShippedScenarios();

// Reads a shipped scenario by name, or a .toml by path, then applies `assignments` ("key=value") in order.
// InputError: the scenario or an assignment is wrong.
Scenario LoadScenario(const std::string& name_or_path, const std::vector<std::string>& assignments);

// The robot that arm.model names: a shipped one, or a path to an arm file or URDF.
robots::Robot LoadScenarioRobot(const Scenario& scenario);

}  // namespace fovea::sim
