// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/control/reach_watch.hpp"

#include "firmware/core/control/count_tick.hpp"
#include "firmware/core/control/goal_size.hpp"
#include "firmware/core/control/way_to_goal.hpp"
#include "fovea/hal/types.hpp"

namespace fovea::control {
namespace {

constexpr double kGoalNearFraction = 0.005;  // errors below this share of |s_star| count as zero
constexpr double kMovedM = 0.02;             // a target that has moved this far is tried again

}  // namespace

bool IsBlocked(const config::LawConfig& config, const features::FeatureState& feature,
               const VisualLawOutput& law, const model::Mat6N& J_C, const model::VecN& dq,
               hal::LimitSet limits) noexcept {
  return (limits & kBarriers) != 0 && law.e.norm() > kGoalNearFraction * GoalSize(feature) &&
         Progress(feature, law.ds_cmd, J_C, dq) < config.unreachable_progress;
}

void UpdateBlockedTime(bool blocked, ReachWatch& watch) noexcept { CountTick(blocked, watch.blocked_ns); }

bool IsUnreachable(const config::LawConfig& config, const ReachWatch& watch) noexcept {
  return static_cast<double>(watch.blocked_ns) >
         config.unreachable_s * static_cast<double>(hal::kNsPerSecond);
}

bool HasMoved(const model::Vec3& p_BO, const ReachWatch& watch) noexcept {
  return (p_BO - watch.p_BO_unreachable).norm() > kMovedM;
}

}  // namespace fovea::control
