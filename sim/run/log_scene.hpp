// The bench as a log's viewer draws it, and the frames that its parts move with.
#pragma once

#include <vector>

#include "firmware/host/recording/log/run_log.hpp"
#include "sim/render/scene_renderer.hpp"

namespace foxglove {
class SceneUpdate;
}

namespace fovea::sim {

// A frame for each link of `robot`, by its name, as it moves with the joints of `arm` (the servo's model of
// the same robot), and the camera's.
std::vector<log::LinkFrame> MakeLinkFrames(const SimRobot& robot, const model::ArmModel& arm,
                                           const Eigen::Isometry3d& X_EC);

// Links, camera housing, target and table, each in its frame.
foxglove::SceneUpdate MakeSceneMessage(const RenderScene& scene);

}  // namespace fovea::sim
