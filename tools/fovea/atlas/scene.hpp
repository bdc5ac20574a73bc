// SPDX-License-Identifier: Apache-2.0
// What the runs of an atlas have in common: arm, camera, target with its goal, and what the arm must avoid.
// All of it follows from the scenario's keys, so an atlas takes any arm, camera and mount.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/features/target_feature.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/planning/eye_reach.hpp"
#include "firmware/vision/intrinsics.hpp"
#include "tools/fovea/atlas/drawn_arm.hpp"

namespace fovea::atlas {

struct Scene {
  config::ServoConfig servo;  // as the simulator's servo has it
  vision::Intrinsics camera;
  planning::EyeReach reach;        // of the detector
  std::vector<config::Box> boxes;  // on the bench, known to the servo or not
  std::shared_ptr<const DrawnArm> drawn;
};

// Where the target has to be in the camera.
struct Goal {
  std::vector<double> xyz;      // p_CO_C_star [m]
  std::vector<double> rpy_deg;  // R_CO_star

  bool operator==(const Goal&) const = default;
};

// The shipped scenario with this target.
const char* ScenarioOf(const std::string& target);

// The assignments of all runs with `target`: those of the atlas, then the caller's, which override them.
std::vector<std::string> SceneAssignments(const std::vector<std::string>& callers);

// The scene of `target` (a name of features::kTargetNames) with `assignments`, by asking the simulator for
// the values of all keys. InputError: the simulator or the servo refuses them.
Scene LoadScene(const std::string& target, const std::vector<std::string>& assignments);

// The same with another goal.
Scene WithGoal(const Scene& scene, const Goal& goal);

}  // namespace fovea::atlas
