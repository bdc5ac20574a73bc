// SPDX-License-Identifier: Apache-2.0
// The servo's end of the line to its planner: takes plans apart for the ticks, and passes requests on.
#pragma once

#include <cstdint>

#include "firmware/core/trajectory/plan_box.hpp"
#include "firmware/core/trajectory/plan_part.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::trajectory {

class PlanLine {
 public:
  // Borrows `box` until the next call; null: there is no planner. Real-time: yes.
  void Use(PlanBox* box) noexcept { box_ = box; }

  // For the next tick: one part of a plan, or none. A new plan replaces the rest of an old one. It is sent
  // again until the servo no longer awaits it. Real-time: yes.
  [[nodiscard]] PlanPart Next() noexcept {
    if (box_ != nullptr && box_->plans.Take(sender_.plan())) {
      sender_.Begin();
      came_ = true;
    } else if (sender_.IsDone() && came_ && awaits_) {
      sender_.Begin();  // a part was lost on a board's line
    }
    return sender_.Next();
  }

  // After each tick: asks for a plan if the servo does. Real-time: yes.
  void Note(const hal::TickRecord& record) noexcept {
    if (record.way.plans_asked != asked_ && box_ != nullptr) {
      box_->requests.Put(record);
    }
    came_ = came_ && record.way.plans_asked == asked_;
    awaits_ = record.way.way == hal::Way::kAwaitPlan;
    asked_ = record.way.plans_asked;
  }

 private:
  PlanBox* box_ = nullptr;
  PlanSender sender_;
  std::int32_t asked_ = 0;
  bool came_ = false;    // the plan for the last request
  bool awaits_ = false;  // the servo, a plan
};

}  // namespace fovea::trajectory
