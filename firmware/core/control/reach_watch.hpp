// SPDX-License-Identifier: Apache-2.0
// Detects that limits block the arm from its goal, and when the goal is worth another try.
#pragma once

#include <cstdint>

#include "firmware/core/config/law_config.hpp"
#include "firmware/core/control/visual_law.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::control {

struct ReachWatch {
  std::int64_t blocked_ns = 0;                         // blocked time less unblocked time, at least 0
  model::Vec3 p_BO_unreachable = model::Vec3::Zero();  // the target's place when it was unreachable [m]
  bool planner_was_late = false;                       // the planner did not answer then
};

// True if barriers among `limits` kept a tick of the visual law from its goal: `dq` [num_joints], the joint
// velocity that was left of `law`, achieves too little of the commanded feature motion. Real-time: yes.
[[nodiscard]] bool IsBlocked(const config::LawConfig& config, const features::FeatureState& feature,
                             const VisualLawOutput& law, const model::Mat6N& J_C, const model::VecN& dq,
                             hal::LimitSet limits) noexcept;

// One tick of steering. `blocked`: limits kept the arm from the goal. Noise unblocks single ticks, so that
// the balance of blocked and unblocked ticks counts. Real-time: yes.
void UpdateBlockedTime(bool blocked, ReachWatch& watch) noexcept;

[[nodiscard]] bool IsUnreachable(const config::LawConfig& config, const ReachWatch& watch) noexcept;

// True if the target, at `p_BO` [m], has moved since it was unreachable.
[[nodiscard]] bool HasMoved(const model::Vec3& p_BO, const ReachWatch& watch) noexcept;

}  // namespace fovea::control
