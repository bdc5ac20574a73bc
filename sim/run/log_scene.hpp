// SPDX-License-Identifier: Apache-2.0
// The bench for a log viewer, and the frames of its moving parts.
#pragma once

#include <vector>

#include "firmware/host/recording/log/run_log.hpp"
#include "sim/render/scene_renderer.hpp"

namespace foxglove {
class SceneUpdate;
}

namespace fovea::sim {

// The frame of each link of `robot`, by its name, relative to the joint of `arm` that moves it, and the
// camera's frame. `arm` is the servo's model of the same robot.
std::vector<log::LinkFrame> MakeLinkFrames(const SimRobot& robot, const model::ArmModel& arm,
                                           const Eigen::Isometry3d& X_EC);

// Links, camera housing, target and table, each in its frame.
foxglove::SceneUpdate MakeSceneMessage(const RenderScene& scene);

}  // namespace fovea::sim
