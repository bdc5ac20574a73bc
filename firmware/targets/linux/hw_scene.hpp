// The arm and its target as a log's viewer draws them, from nothing but the servo's model.
#pragma once

#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/robots/robot.hpp"

namespace foxglove {
class SceneUpdate;
}

namespace fovea::hw {

// A frame for the base and for each joint, by their names in the robot's description, and with a camera
// its own. X_EC: where it is mounted.
std::vector<log::LinkFrame> MakeLinkFrames(const robots::Robot& robot, bool has_camera,
                                           const model::Pose& X_EC);

// Each link as a rod from its joint to the next; with a camera its housing, and the target.
foxglove::SceneUpdate MakeSceneMessage(const robots::Robot& robot, bool has_camera,
                                       const features::TargetFeature& target);

}  // namespace fovea::hw
