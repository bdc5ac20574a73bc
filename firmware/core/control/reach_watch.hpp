// Whether limits keep the arm from its goal for good, and when the goal is worth another try.
#pragma once

#include <cstdint>

#include "firmware/core/config/law_config.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::control {

struct ReachWatch {
  std::int64_t blocked_ns = 0;  // how much longer limits have kept the arm from the goal than not
  model::Vec3 p_BO_unreachable = model::Vec3::Zero();  // where the target was that could not be reached [m]
};

// One tick of steering: whether limits kept the arm from the goal. Noise lets it through for a tick now and
// then: what counts is how often it is kept. Real-time: yes.
void UpdateBlockedTime(bool blocked, ReachWatch& watch) noexcept;

[[nodiscard]] bool IsUnreachable(const config::LawConfig& config, const ReachWatch& watch) noexcept;

// Whether the target, at `p_BO` [m], has moved since it could not be reached.
[[nodiscard]] bool HasMoved(const model::Vec3& p_BO, const ReachWatch& watch) noexcept;

}  // namespace fovea::control
