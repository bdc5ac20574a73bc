// SPDX-License-Identifier: Apache-2.0
// The target of a scenario: its shape, pose and motion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/host/config/target_keys.hpp"
#include "sim/physics/rolling_ball.hpp"
#include "sim/render/target_shape.hpp"
#include "sim/robot/sim_robot.hpp"
#include "sim/world/target_motion.hpp"

namespace fovea::sim {

struct TargetScene : config::TargetSettings {
  std::vector<double> position{0.56, 0.14, 0.04};
  std::vector<double> rpy_deg{180.0, 0.0, -90.0};
  std::vector<double> colour{0.74, 0.07, 0.06};
  std::string motion = "still";
  double path_radius = 0.10;
  double path_yaw_deg = 90.0;
  double speed = 0.2;
  std::vector<double> jump{0.0, -0.10, 0.0};
  double jump_s = 4.0;
  std::vector<double> push{0.0, -0.06, 0.0};
  double push_s = 3.0;
  double mass = 0.2;
  double friction = 0.5;
  double rolling_resistance = 0.001;
  double air_damping = 0.05;
  double turn_deg_s = 0.0;
  bool clutter = false;
};

// The scene must outlive the table.
void AddTargetSceneKeys(TargetScene& scene, config::KeyTable& keys);

// `seed`: for a random motion.
TargetMotion MakeTargetMotion(const TargetScene& scene, std::uint64_t seed);
// The pushed ball, if the scene has one. InputError: the target is no sphere, or it is inside the table.
RollingBallConfig MakeRollingBall(const TargetScene& scene);
TargetShape MakeTargetShape(const features::TargetFeature& feature);
// The target's collision shape. A flat target is a plate, 2 mm thick, behind its painted side.
Shape MakeTargetBody(const TargetShape& shape);

// Hue of a colour {red, green, blue}, each from 0 to 1 [deg]: 0 red, 120 green, 240 blue; none for gray.
std::optional<double> HueOfColour(const std::vector<double>& rgb);

// Whether the target moves all the time. The verdict then judges tracking.
bool KeepsMoving(const TargetScene& scene);

}  // namespace fovea::sim
