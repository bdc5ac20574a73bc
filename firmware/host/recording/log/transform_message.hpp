// SPDX-License-Identifier: Apache-2.0
// The poses of an arm's frames for a viewer: /tf.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/core/model/arm_model.hpp"

namespace foxglove {
class FrameTransforms;
}

namespace fovea::log {

struct LinkFrame;

// Sets `message` to the poses of `frames` in B at the joint positions `q` [arm.num_joints; rad, m], and of
// the target's frame if `X_BO` is there. The message may be reused: its old content is replaced.
void SetTransforms(std::int64_t stamp_ns, const model::ArmModel& arm, const std::vector<LinkFrame>& frames,
                   const model::VecN& q, const std::optional<model::Pose>& X_BO,
                   foxglove::FrameTransforms& message);

}  // namespace fovea::log
