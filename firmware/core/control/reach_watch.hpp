// Detects that limits block the arm from its goal, and when the goal is worth another try.
#pragma once

#include <cstdint>

#include "firmware/core/config/law_config.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::control {

struct ReachWatch {
  std::int64_t blocked_ns = 0;                         // blocked time less unblocked time, at least 0
  model::Vec3 p_BO_unreachable = model::Vec3::Zero();  // the target's place when it was unreachable [m]
};

// One tick of steering. `blocked`: limits kept the arm from the goal. Noise unblocks single ticks, so that
// the balance of blocked and unblocked ticks counts. Real-time: yes.
void UpdateBlockedTime(bool blocked, ReachWatch& watch) noexcept;

[[nodiscard]] bool IsUnreachable(const config::LawConfig& config, const ReachWatch& watch) noexcept;

// True if the target, at `p_BO` [m], has moved since it was unreachable.
[[nodiscard]] bool HasMoved(const model::Vec3& p_BO, const ReachWatch& watch) noexcept;

}  // namespace fovea::control
