// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/plan_part.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::trajectory {
namespace {

constexpr double kMost = 1e4;  // of a control point [rad, m]

}  // namespace

PlanPart PartOf(const Plan& plan, int first) noexcept {
  PlanPart part;
  part.head = plan;
  part.first = first;
  part.count = std::clamp(plan.NumNumbers() - first, 0, PlanPart::kMostNumbers);
  std::copy_n(plan.points.begin() + first, part.count, part.numbers.begin());
  return part;
}

bool PlanReceiver::Take(const PlanPart& part) noexcept {
  if (part.first == 0 && (received_ <= 0 || part.head.stamp_ns != plan_.stamp_ns)) {
    static_cast<PlanHead&>(plan_) = part.head;
    received_ = 0;
  }
  const bool continues = part.first >= 0 && part.first == received_ && part.head.stamp_ns == plan_.stamp_ns;
  if (!continues || part.count < 0) {
    return false;  // what is missing comes again
  }
  bool sound = plan_.IsHeadSound() && part.count <= PlanPart::kMostNumbers &&
               received_ + part.count <= plan_.NumNumbers();
  for (std::int32_t i = 0; sound && i < part.count; ++i) {
    const double number = part.numbers[static_cast<std::size_t>(i)];
    sound = std::fabs(number) <= kMost;
    plan_.points[static_cast<std::size_t>(received_ + i)] = number;
  }
  if (!sound) {
    plan_ = Plan{};
    received_ = -1;  // no part continues this
    return false;
  }
  received_ += part.count;
  return received_ == plan_.NumNumbers();
}

}  // namespace fovea::trajectory
