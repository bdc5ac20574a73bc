// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/push.hpp"

#include <cmath>

#include "fovea/hal/types.hpp"

namespace fovea::estimate {
namespace {

constexpr double kFollowShare = hal::kTickPeriodS / PushWatch::kFollowS;  // per tick
constexpr auto kSettleTicks = static_cast<std::int32_t>(1.0 / kFollowShare);

}  // namespace

void WatchPush(const model::VecN& tau_ext, PushWatch& watch) noexcept {
  if (watch.ticks == 0 && tau_ext.isZero(0.0)) {
    return;  // the observer has not begun
  }
  if (watch.ticks < kSettleTicks) {
    ++watch.ticks;
    watch.followed = tau_ext;
  } else {
    watch.followed += kFollowShare * (tau_ext - watch.followed);
  }
}

PushShares SharesOf(const model::ArmModel& arm, const model::VecN& tau_ext, const PushWatch& watch,
                    int i) noexcept {
  const double most = arm.joints[static_cast<std::size_t>(i)].tau_max;
  const double followed = watch.ticks > 0 ? watch.followed[i] : tau_ext[i];
  return {std::fabs(tau_ext[i]) / most, std::fabs(tau_ext[i] - followed) / most};
}

std::int32_t PushedJoint(const model::ArmModel& arm, const PushShares& limits, const model::VecN& tau_ext,
                         const PushWatch& watch) noexcept {
  for (int i = 0; i < tau_ext.size(); ++i) {
    const PushShares shares = SharesOf(arm, tau_ext, watch, i);
    if (!(shares.total <= limits.total && shares.sudden <= limits.sudden)) {
      return i;
    }
  }
  return -1;
}

}  // namespace fovea::estimate
