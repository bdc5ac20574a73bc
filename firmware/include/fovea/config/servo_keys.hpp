// The keys of sections [servo], [safety] and [vision], the same for the simulator and for hardware.
#pragma once

#include <string>
#include <vector>

#include "fovea/config/key_table.hpp"
#include "fovea/robots/robot.hpp"
#include "fovea/servo/servo_config.hpp"
#include "fovea/vision/ball_detector.hpp"

namespace fovea::config {

// What the keys set, before robot, camera mount and target are known.
struct ServoSettings {
  servo::ServoConfig config;
  std::vector<double> goal{0.0, 0.0, 0.40};  // p_CO_C_star [m]
  std::vector<double> posture;               // empty: the robot's ready posture
  std::vector<double> planes;                // n_x, n_y, n_z, d of each
  std::vector<double> boxes;                 // low x, y, z, high x, y, z of each
  std::string motion_law = "computed_torque";
  std::vector<double> k_p;  // per joint; empty: omega_n^2 times the inertia in the ready posture
  std::vector<double> k_v;  // per joint; empty: by zeta, from k_p and that inertia
};

struct VisionSettings {
  vision::BallDetectorConfig config;
  std::string method = "colour";
};

// The settings must outlive the table.
void AddServoKeys(ServoSettings& settings, KeyTable& keys);
void AddVisionKeys(VisionSettings& settings, KeyTable& keys);

// The servo's whole configuration for `robot`, with the camera at `X_EC` and a ball of radius `target_radius`
// [m]. InputError: a posture that does not fit the robot, or anything that ServoTask::Init refuses.
servo::ServoConfig MakeServoConfig(const ServoSettings& settings, const robots::Robot& robot,
                                   const model::Pose& X_EC, double target_radius);

// The detector's whole configuration.
vision::BallDetectorConfig MakeVisionConfig(const VisionSettings& settings,
                                            const vision::Intrinsics& intrinsics, double target_radius);

}  // namespace fovea::config
