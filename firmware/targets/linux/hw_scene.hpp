// SPDX-License-Identifier: Apache-2.0
// The arm and its target for a log's viewer, made only from the servo's model.
#pragma once

#include <vector>

#include "firmware/core/features/target_feature.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/robots/robot.hpp"

namespace foxglove {
class SceneUpdate;
}

namespace fovea::hw {

// A frame for the base and for each joint, named as in the robot's description, and one for the camera if
// there is one. X_EC: pose of the camera on the end effector.
std::vector<log::LinkFrame> MakeLinkFrames(const robots::Robot& robot, bool has_camera,
                                           const model::Pose& X_EC);

// Each link as a rod from its joint to the next; with a camera also its housing and the target.
foxglove::SceneUpdate MakeSceneMessage(const robots::Robot& robot, bool has_camera,
                                       const features::TargetFeature& target);

}  // namespace fovea::hw
