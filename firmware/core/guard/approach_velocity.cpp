// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/guard/approach_velocity.hpp"

#include <algorithm>

#include "firmware/core/trajectory/joint_pace.hpp"
#include "firmware/core/trajectory/velocity_step.hpp"

namespace fovea::guard {
namespace {

using hal::Bit;
using hal::Limit;
using model::VecN;

constexpr double kLeastShare = 1e-3;  // of its limits that a joint keeps

trajectory::AxisLimits LimitsOf(const config::ServoConfig& config, int i) noexcept {
  const trajectory::JointPace pace = trajectory::PaceOf(config, i);
  return {0.0, pace.ddq_max, pace.dddq_max};
}

trajectory::AxisState StateOf(const trajectory::Reference& reference, int i) noexcept {
  return {reference.q[i], reference.dq[i], reference.ddq[i]};
}

void Advance(const VecN& ddq, trajectory::Reference& reference) noexcept {
  reference.ddq = ddq;
  reference.dq += hal::kTickPeriodS * ddq;
  reference.q += hal::kTickPeriodS * reference.dq;
}

// Each joint by itself.
struct Alone {
  VecN ddq;
  hal::LimitSet limits = 0;
  bool reach = true;  // all joints reach their wishes in this tick
};

Alone StepAlone(const config::ServoConfig& config, const VecN& dq, const VecN& ddq,
                const trajectory::Reference& reference) noexcept {
  Alone alone;
  alone.ddq.resize(dq.size());
  for (int i = 0; i < dq.size(); ++i) {
    const trajectory::VelocityStep step = trajectory::StepVelocity(StateOf(reference, i), dq[i], ddq[i],
                                                                   LimitsOf(config, i), hal::kTickPeriodS);
    alone.ddq[i] = step.state.a;
    alone.limits |= step.at_a_max ? Bit(Limit::kJointAcceleration) : 0;
    alone.limits |= step.at_j_max ? Bit(Limit::kJointJerk) : 0;
    alone.reach = alone.reach && step.reaches;
  }
  return alone;
}

}  // namespace

hal::LimitSet ApproachAlone(const config::ServoConfig& config, const VecN& dq, const VecN& ddq,
                            trajectory::Reference& reference) noexcept {
  const Alone alone = StepAlone(config, dq, ddq, reference);
  Advance(alone.ddq, reference);
  return alone.limits;
}

hal::LimitSet ApproachTogether(const config::ServoConfig& config, const VecN& dq, const VecN& ddq,
                               trajectory::Reference& reference) noexcept {
  const Alone alone = StepAlone(config, dq, ddq, reference);
  VecN next = alone.ddq;
  if (!alone.reach) {
    VecN times(dq.size());  // that each joint needs alone [s]
    for (int i = 0; i < dq.size(); ++i) {
      times[i] = trajectory::PlanVelocityChange(reference.dq[i] - dq[i], reference.ddq[i] - ddq[i], 0.0,
                                                LimitsOf(config, i))
                     .Duration();
    }
    const double longest = times.maxCoeff();  // 0: all have their wishes, but not its rate
    for (int i = 0; i < dq.size(); ++i) {
      const double ahead = dq[i] - reference.dq[i];
      if (ahead * reference.ddq[i] < 0.0) {
        continue;  // it still accelerates away from its wish
      }
      const double share = longest > 0.0 ? std::max(times[i] / longest, kLeastShare) : 1.0;
      trajectory::AxisLimits limits = LimitsOf(config, i);
      limits.a_max *= share;
      limits.j_max *= share * share;
      const double slowed =
          trajectory::StepVelocity(StateOf(reference, i), dq[i], ddq[i], limits, hal::kTickPeriodS).state.a;
      next[i] = ahead > 0.0 ? std::min(slowed, next[i]) : std::max(slowed, next[i]);
    }
  }
  Advance(next, reference);
  return alone.limits;
}

}  // namespace fovea::guard
