// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/plan.hpp"

#include <cmath>

namespace fovea::trajectory {

bool PlanHead::IsHeadSound() const noexcept {
  if (outcome != PlanOutcome::kFound) {
    return num_points == 0 && static_cast<std::size_t>(outcome) < kPlanOutcomeWords.size();
  }
  bool finite = std::isfinite(period_s);
  for (const double p : p_BO) {
    finite = finite && std::isfinite(p);
  }
  for (const double q : q_BO) {
    finite = finite && std::isfinite(q);
  }
  return finite && turn >= 0 && turn < kMostTurns && num_joints >= 1 && num_joints <= model::kMaxJoints &&
         num_points >= kLeastPoints && num_points <= Capacity(num_joints) && period_s > 0.0 &&
         Duration() <= kMostDuration;
}

bool Plan::IsSound() const noexcept {
  bool sound = IsHeadSound();
  for (std::size_t i = 0; sound && i < static_cast<std::size_t>(NumNumbers()); ++i) {
    sound = std::isfinite(points[i]);
  }
  return sound;
}

void Plan::At(double t, Reference& reference) const noexcept {
  const int last = num_points - kLeastPoints;  // span
  const bool over = !(t < Duration());
  const double at = t > 0.0 ? t / period_s : 0.0;
  const int span = over || at >= static_cast<double>(last) ? last : static_cast<int>(at);
  const double x = over ? 1.0 : at - static_cast<double>(span);
  const double y = 1.0 - x;
  const double b_0 = y * y * y / 6.0;
  const double b_2 = (4.0 + y * y * (3.0 * y - 6.0)) / 6.0;
  const double b_3 = x * x * x / 6.0;
  reference.q.resize(num_joints);
  reference.dq.resize(num_joints);
  reference.ddq.resize(num_joints);
  for (int j = 0; j < num_joints; ++j) {
    const double c_1 = Point(span + 1, j);
    const double step_0 = c_1 - Point(span, j);
    const double step_1 = Point(span + 2, j) - c_1;
    const double step_2 = Point(span + 3, j) - Point(span + 2, j);
    // Relative to one control point, so that equal ones give exactly that point.
    reference.q[j] = c_1 - b_0 * step_0 + (b_2 + b_3) * step_1 + b_3 * step_2;
    reference.dq[j] =
        over ? 0.0 : (0.5 * y * y * step_0 + (0.5 + x * y) * step_1 + 0.5 * x * x * step_2) / period_s;
    reference.ddq[j] = over ? 0.0 : (y * (step_1 - step_0) + x * (step_2 - step_1)) / (period_s * period_s);
  }
}

}  // namespace fovea::trajectory
